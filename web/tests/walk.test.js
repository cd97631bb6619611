import assert from 'node:assert/strict';
import { test } from 'node:test';
import { metadata, newWalker, rules } from './load.js';

const walker = await newWalker();
const FORWARD = [0.6, 0, 0];

async function walk(seconds) {
  const ticks = Math.round((seconds / walker.periodS) * walker.robot.substeps);
  for (let i = 0; i < ticks; i++) await walker.tick();
}

for (const skill of metadata.skills) {
  test(`${skill} is walked and told from the contacts`, async (t) => {
    walker.reset();
    Object.assign(walker, { skill, command: FORWARD });
    await walk(4);
    const { frequencyHz, velocity } = walker.measure();
    t.diagnostic(`${frequencyHz.toFixed(2)} strides per s, ${velocity[0].toFixed(2)} m/s`);
    assert.equal(walker.fallen, false);
    assert.equal(walker.measure().skill, skill);
    assert.ok(Math.abs(velocity[0] - FORWARD[0]) < 0.2);
  });
}

test('the skill changes while the robot walks', async () => {
  walker.reset();
  Object.assign(walker, { skill: metadata.skills[0], command: FORWARD });
  await walk(2);
  walker.skill = metadata.skills.at(-1);
  await walk(3);
  assert.equal(walker.measure().skill, metadata.skills.at(-1));
  assert.equal(walker.log.rows[0].skill, metadata.skills[0]);
});

test('a robot that falls is measured no longer and sinks to the ground', async () => {
  walker.reset();
  walker.robot.push(0, 6);
  await walk(2);
  assert.equal(walker.fallen, true);
  assert.equal(walker.measure().gait, rules.no_gait);
  assert.ok(Math.hypot(...walker.robot.readings().jointVelocity) < 1);
  walker.reset();
  assert.equal(walker.fallen, false);
});
