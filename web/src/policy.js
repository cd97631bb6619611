/** The exported network: observation in, joint targets out. */
export class Policy {
  /** ort: onnxruntime-web; model: policy.onnx as Uint8Array; metadata: policy.json. */
  static async load(ort, model, metadata) {
    const session = await ort.InferenceSession.create(model, { executionProviders: ['wasm'] });
    return new Policy(ort, session, metadata);
  }

  constructor(ort, session, metadata) {
    this.ort = ort;
    this.session = session;
    this.metadata = metadata;
  }

  /** Float32Array (45 + K) -> joint targets in rad, Float32Array (12). */
  async jointTarget(observation) {
    const obs = new this.ort.Tensor('float32', observation, [1, observation.length]);
    const { joint_target: answer } = await this.session.run({ obs });
    if (!answer.data.every(Number.isFinite)) {
      throw new Error('the policy answered with something that is no number; build the page again');
    }
    return answer.data;
  }
}
