import assert from 'node:assert/strict';
import { test } from 'node:test';
import { observe, remembered } from '../src/observation.js';
import { golden, metadata, newRobot, newWalker } from './load.js';

const skip = !golden && 'needs tests/test_web.py';

function largestDifference(found, expected) {
  assert.equal(found.length, expected.length);
  return Math.max(...expected.map((value, i) => Math.abs(value - found[i])));
}

test('observation, joint targets and velocity are those of camp.deploy', { skip }, async (t) => {
  const { robot, policy } = await newWalker();
  const largest = { observation: 0, joint_target: 0, velocity: 0 };
  let frames = [];
  for (const state of golden.observations) {
    robot.data.qpos.set(state.qpos);
    robot.data.qvel.set(state.qvel);
    const observation = observe(metadata, robot.readings(), state.command, state.last_action, state.skill);
    frames = remembered(frames, observation, metadata.history);
    const target = await policy.jointTarget(Float32Array.from(frames.flatMap((one) => [...one])));
    const answers = { observation, joint_target: target, velocity: robot.velocity() };
    for (const [name, value] of Object.entries(answers)) {
      largest[name] = Math.max(largest[name], largestDifference([...value], state[name]));
    }
  }
  t.diagnostic(`${golden.observations.length} states, largest differences ${JSON.stringify(largest)}`);
  for (const [name, difference] of Object.entries(largest)) assert.ok(difference < 1e-5, name);
});

test('the policy sees the last control steps, the oldest first, and the first one for those before it', () => {
  let frames = [];
  const seen = [1, 2, 3, 4].map((frame) => (frames = remembered(frames, frame, 3)));
  assert.deepEqual(seen, [[1, 1, 1], [1, 1, 2], [1, 2, 3], [2, 3, 4]]);
  assert.deepEqual(remembered([5], 6, 1), [6]);
});

test('entries are in the order of the metadata, and a skill that is not observed is zeros', () => {
  const described = {
    default_pose: [1, 2],
    skills: ['trot', 'pace'],
    observe_skill: false,
    observation: [
      { name: 'skill', size: 2 },
      { name: 'joint_position', size: 2 },
      { name: 'command', size: 3 },
    ],
  };
  const still = { jointVelocity: [0, 0], gravity: [0, 0, -1], angularVelocity: [0, 0, 0] };
  const readings = { jointPosition: [1.5, 2.25], ...still };
  const observed = (skill) => [...observe(described, readings, [1, 2, 3], [0, 0], skill)];
  assert.deepEqual(observed('pace'), [0, 0, 0.5, 0.25, 1, 2, 3]);
  assert.throws(() => observed('hop'), /unknown to this policy; choose one of trot/);
  described.observation.push({ name: 'camera', size: 9 });
  assert.throws(() => observed('pace'), /observation "camera" of size 9/);
});

test('joints and gains are taken by name', async () => {
  const names = [...metadata.joint_names].reverse();
  const pose = [...metadata.default_pose].reverse();
  const described = { ...metadata, joint_names: names, default_pose: pose, kp: names.map((_, i) => i + 1) };
  const robot = await newRobot(described);
  const hip = robot.actuators[names.indexOf('FL_hip_joint')];
  assert.equal(robot.model.actuator_gainprm[10 * hip], 12);
  assert.equal(robot.model.actuator_biasprm[10 * hip + 1], -12);
  assert.equal(robot.readings().jointPosition[names.indexOf('RR_calf_joint')], metadata.default_pose.at(-1));
});

test('the robot starts on its feet, and one on its side has fallen', async () => {
  const robot = await newRobot();
  const heights = robot.feet.map((foot) => robot.data.geom_xpos[3 * foot + 2] - robot.model.geom_size[3 * foot]);
  assert.ok(Math.abs(Math.min(...heights)) < 1e-9);
  assert.deepEqual(robot.readings().gravity.map((value) => Math.round(value) + 0), [0, 0, -1]);
  assert.equal(robot.fallen(), false);
  robot.data.qpos.set([Math.cos(0.45), Math.sin(0.45), 0, 0], 3); // .9 rad of roll
  assert.equal(robot.fallen(), true);
});

test('a control period that the physics timestep does not divide is refused', async () => {
  await assert.rejects(newRobot({ ...metadata, control_period: 0.022 }), /no multiple of the physics timestep/);
});
