/** One simulated robot on flat ground. Joints are in the order of the metadata's joint_names, units are SI. */
export class Robot {
  /** mujoco: the loaded engine; xml: the robot's model; metadata: policy.json; rules: rules.json. */
  constructor(mujoco, xml, metadata, rules) {
    this.mujoco = mujoco;
    this.rules = rules;
    this.model = mujoco.MjModel.from_xml_string(xml);
    this.data = new mujoco.MjData(this.model);
    const { model } = this;
    const joints = metadata.joint_names.map((name) => this.id('mjOBJ_JOINT', name));
    this.positionAt = joints.map((joint) => model.jnt_qposadr[joint]);
    this.velocityAt = joints.map((joint) => model.jnt_dofadr[joint]);
    this.actuators = metadata.joint_names.map((name) => this.id('mjOBJ_ACTUATOR', name));
    this.feet = rules.feet.map((leg) => this.id('mjOBJ_GEOM', `${leg}_foot`));
    this.sensorAt = new Map();
    this.trunkParts = ['base', ...rules.feet.map((leg) => `${leg}_thigh`)];
    this.pose = metadata.default_pose;
    this.setGains(metadata.kp, metadata.kd);
    this.substeps = Math.round(metadata.control_period / model.opt.timestep);
    if (Math.abs(this.substeps * model.opt.timestep - metadata.control_period) > 1e-9) {
      throw new Error(`control_period ${metadata.control_period} s: no multiple of the physics timestep`);
    }
    this.stand();
  }

  id(kind, name) {
    const found = this.mujoco.mj_name2id(this.model, this.mujoco.mjtObj[kind].value, name);
    if (found < 0) throw new Error(`robot.xml has no ${name}: build the page again`);
    return found;
  }

  /** A position actuator's force is kp (target - q) - kd q', clipped at the torque limit in the model. */
  setGains(kp, kd) {
    const { actuator_gainprm: gain, actuator_biasprm: bias, nu } = this.model;
    const [gainWidth, biasWidth] = [gain.length / nu, bias.length / nu];
    this.actuators.forEach((actuator, i) => {
      gain[actuator * gainWidth] = kp[i];
      bias[actuator * biasWidth + 1] = -kp[i];
      bias[actuator * biasWidth + 2] = -kd[i];
    });
  }

  /** At rest in the default pose, the lowest foot just touching the ground. */
  stand() {
    const { mujoco, model, data } = this;
    mujoco.mj_resetData(model, data);
    this.positionAt.forEach((at, i) => (data.qpos[at] = this.pose[i]));
    this.aim(this.pose);
    mujoco.mj_kinematics(model, data);
    data.qpos[2] -= Math.min(...this.feet.map((foot) => data.geom_xpos[3 * foot + 2] - model.geom_size[3 * foot]));
    mujoco.mj_forward(model, data);
  }

  /** Joint targets (12,) in rad, held until the next ones. */
  aim(target) {
    const { ctrl } = this.data;
    this.actuators.forEach((actuator, i) => (ctrl[actuator] = target[i]));
  }

  /** Simulate one physics timestep. */
  step() {
    const before = this.data.time;
    this.mujoco.mj_step(this.model, this.data);
    if (!(this.data.time > before)) throw new Error('the simulation diverged; check the metadata\'s kp and kd');
  }

  /** Change the trunk's velocity at once, m/s in the world frame. */
  push(vx, vy) {
    this.data.qvel[0] += vx;
    this.data.qvel[1] += vy;
  }

  /** What the robot's own sensors tell: (3,) rad/s, unit vector (3,), (12,) rad, (12,) rad/s; base frame. */
  readings() {
    const { qpos, qvel } = this.data;
    const [w, x, y, z] = qpos.subarray(3, 7);
    return {
      angularVelocity: [...qvel.subarray(3, 6)],
      gravity: [2 * (w * y - x * z), -2 * (w * x + y * z), 2 * (x * x + y * y) - 1],
      jointPosition: this.positionAt.map((at) => qpos[at]),
      jointVelocity: this.velocityAt.map((at) => qvel[at]),
    };
  }

  /** vx, vy in m/s and yaw rate in rad/s in the base frame. Measured, not observed by the policy. */
  velocity() {
    const { qpos, qvel } = this.data;
    const [w, x, y, z] = qpos.subarray(3, 7);
    const [a, b, c] = qvel.subarray(0, 3);
    return [
      (1 - 2 * (y * y + z * z)) * a + 2 * (x * y + w * z) * b + 2 * (x * z - w * y) * c,
      2 * (x * y - w * z) * a + (1 - 2 * (x * x + z * z)) * b + 2 * (y * z + w * x) * c,
      qvel[5],
    ];
  }

  /** Heading of the trunk in the world, rad to the left of its x axis. */
  heading() {
    const [w, x, y, z] = this.data.qpos.subarray(3, 7);
    return Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  }

  /** Whether a foot ("FL"), the base ("base") or a thigh ("FL_thigh") presses on the ground. */
  touches(part) {
    if (!this.sensorAt.has(part)) {
      this.sensorAt.set(part, this.model.sensor_adr[this.id('mjOBJ_SENSOR', `${part}_contact`)]);
    }
    const at = this.sensorAt.get(part);
    return Math.hypot(...this.data.sensordata.subarray(at, at + 3)) > this.rules.contact_force_n;
  }

  /** Which feet press on the ground, in the order of the rules' feet. */
  contacts() {
    return this.rules.feet.map((leg) => this.touches(leg));
  }

  /** The base or a thigh on the ground, or the trunk tilted too far. */
  fallen() {
    const [, x, y] = this.data.qpos.subarray(3, 7); // w, x, y, z
    const upright = 1 - 2 * (x * x + y * y);
    const tilt = Math.acos(Math.min(1, Math.max(-1, upright)));
    return tilt > this.rules.fall_tilt_rad || this.trunkParts.some((part) => this.touches(part));
  }
}
