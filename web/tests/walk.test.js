import assert from 'node:assert/strict';
import { test } from 'node:test';
import { golden, metadata, newWalker, rules } from './load.js';

const walker = await newWalker();
const FORWARD = golden?.command ?? [0.6, 0, 0];
const SECONDS = golden?.seconds ?? 4;

async function walk(seconds) {
  const ticks = Math.round((seconds / walker.periodS) * walker.robot.substeps);
  for (let i = 0; i < ticks; i++) await walker.tick();
}

function largestDifference(found, expected) {
  return Math.max(...expected.map((value, i) => Math.abs(value - found[i])));
}

for (const [k, skill] of metadata.skills.entries()) {
  test(`${skill} is walked and told from the contacts, as in camp.deploy`, async (t) => {
    const python = golden?.walks[k]; // of the same length from the same start
    walker.reset();
    Object.assign(walker, { skill, command: FORWARD });
    let [apart, apartAtEnd] = [0, 0]; // rad or m, over the first half second, and at the end
    for (let row = 0; row < Math.round(SECONDS / walker.periodS); row++) {
      await walk(walker.periodS);
      if (python) apartAtEnd = largestDifference(walker.robot.data.qpos, python.qpos[row]);
      if (row < 25) apart = Math.max(apart, apartAtEnd);
    }
    const { skill: shown, frequencyHz, velocity } = walker.measure();
    t.diagnostic(`${skill}: ${frequencyHz.toFixed(3)} strides per s, ${velocity[0].toFixed(3)} m/s forward`);
    assert.equal(walker.fallen, false);
    assert.equal(shown, skill);
    assert.ok(Math.abs(velocity[0] - FORWARD[0]) < 0.2);
    if (!python) return;
    t.diagnostic(
      `Python: ${python.frequency_hz.toFixed(3)} and ${python.velocity[0].toFixed(3)}; poses ` +
        `${apart.toExponential(1)} apart in the first half second, ${apartAtEnd.toExponential(1)} at the end`,
    );
    assert.ok(apart < 0.02);
    assert.ok(Math.abs(frequencyHz - python.frequency_hz) < 0.1);
    assert.ok(Math.abs(velocity[0] - python.velocity[0]) < 0.1);
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
  walker.push(0, 6);
  await walk(4);
  assert.equal(walker.fallen, true);
  assert.deepEqual(walker.log.rows.map((row) => row.pushed).indexOf(true), 0);
  assert.equal(walker.measure().gait, rules.no_gait);
  assert.ok(Math.hypot(...walker.robot.readings().jointVelocity) < 1);
  walker.reset();
  assert.equal(walker.fallen, false);
});
