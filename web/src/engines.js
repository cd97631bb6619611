import loadMujoco from '@mujoco/mujoco';
import * as ort from 'onnxruntime-web/wasm';
import { address } from './files.js';

/** MuJoCo and ONNX Runtime, each with its WebAssembly from this page's folder. One thread: no headers are needed. */
export async function loadEngines() {
  ort.env.wasm.numThreads = 1;
  ort.env.wasm.wasmPaths = address('ort/');
  const mujoco = await loadMujoco({ locateFile: (name) => address(name) });
  return { mujoco, ort };
}
