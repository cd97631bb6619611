import { debounced, WalkLog } from './contacts.js';
import { measureGait } from './gait.js';
import { observe, remembered } from './observation.js';
import { performed } from './skills.js';

const KEPT_S = 8; // of the walk's log
const MEASURED_EVERY_S = 0.1;

/** The control loop: a robot that follows a policy, and the measure of what it does. */
export class Walker {
  /** robot: Robot; policy: Policy; rules: rules.json. */
  constructor(robot, policy, rules) {
    this.robot = robot;
    this.policy = policy;
    this.rules = rules;
    this.metadata = policy.metadata;
    this.periodS = this.metadata.control_period;
    this.log = new WalkLog(Math.round(KEPT_S / this.periodS));
    this.skill = this.metadata.skills[0];
    this.command = [0, 0, 0];
    this.reset();
  }

  /** Stand the robot up at the start. Skill and command stay as they are. */
  reset() {
    this.robot.stand();
    this.log.clear();
    this.lastAction = new Float32Array(this.metadata.default_pose.length);
    this.frames = [];
    this.substep = 0;
    this.fallen = false;
    this.pushed = false;
    this.measured = this.nothing();
  }

  /** Change the trunk's velocity at once, m/s in the world frame. */
  push(vx, vy) {
    this.robot.push(vx, vy);
    this.pushed = true;
  }

  /** Advance by one physics timestep; the policy is asked at the first of each control period. */
  async tick() {
    if (this.substep === 0) await this.decide();
    this.robot.step();
    this.substep = (this.substep + 1) % this.robot.substeps;
    if (this.substep === 0) this.record();
  }

  async decide() {
    const readings = this.robot.readings();
    if (this.fallen) {
      this.robot.aim(readings.jointPosition); // nothing but the motors' damping: it sinks to the ground
      return;
    }
    const { default_pose: pose, action_scale: scale, history } = this.metadata;
    const frame = observe(this.metadata, readings, this.command, this.lastAction, this.skill);
    this.frames = remembered(this.frames, frame, history);
    const target = await this.policy.jointTarget(Float32Array.from(this.frames.flatMap((one) => [...one])));
    this.robot.aim(target);
    this.lastAction = target.map((angle, i) => (angle - pose[i]) / scale);
  }

  record() {
    const { robot, log } = this;
    this.fallen ||= robot.fallen();
    if (log.count % Math.round(MEASURED_EVERY_S / this.periodS) === 0) this.measured = this.measure();
    const { skill, pushed, measured } = this;
    log.add({ contact: robot.contacts(), velocity: robot.velocity(), skill, pushed, gait: measured.gait });
    this.pushed = false;
  }

  /** What the feet and the trunk did in the latest window. */
  measure() {
    const length = Math.round(this.rules.window_s / this.periodS);
    if (this.fallen || this.log.rows.length < length) return this.nothing();
    const contact = debounced(this.log.rows.map((row) => row.contact), this.periodS, this.rules.bounce_s);
    const gait = measureGait(contact.slice(-length), this.periodS, this.rules);
    const rows = this.log.latest(length);
    return {
      gait: gait.label,
      frequencyHz: gait.frequencyHz,
      skill: performed(gait.label, gait.frequencyHz, this.metadata.skills, this.rules),
      velocity: [0, 1, 2].map((axis) => rows.reduce((total, row) => total + row.velocity[axis], 0) / rows.length),
    };
  }

  nothing() {
    return { gait: this.rules.no_gait, frequencyHz: NaN, skill: null, velocity: null };
  }
}
