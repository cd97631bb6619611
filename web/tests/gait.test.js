import assert from 'node:assert/strict';
import { test } from 'node:test';
import { debounced } from '../src/contacts.js';
import { measureGait, phaseError } from '../src/gait.js';
import { performed, splitName } from '../src/skills.js';
import { golden, rules } from './load.js';

const PERIOD = 0.02; // s

/** A leg stands while frequency * time - offset, modulo 1, is below the duty. */
function sequence(phases, frequency, duty, steps) {
  return Array.from({ length: steps }, (_, row) =>
    phases.map((offset) => {
      const stride = row * PERIOD * frequency - offset + 0.123;
      return stride - Math.floor(stride) < duty;
    }),
  );
}

function close(found, expected, tolerance) {
  assert.ok(Math.abs(found - expected) <= tolerance, `${found} is not ${expected}`);
}

for (const { name, phases } of rules.gaits) {
  test(`${name} is told from two strides and more`, () => {
    for (const frequency of [2, 3, 4]) {
      const measured = measureGait(sequence(phases, frequency, 0.5, 50), PERIOD, rules);
      assert.equal(measured.label, name);
      close(measured.frequencyHz, frequency, 0.03 * frequency);
      measured.duty.forEach((duty) => close(duty, 0.5, 0.05));
    }
  });
}

test('standing, hanging and a walk are no gait of these', () => {
  const still = (stands) => Array.from({ length: 50 }, () => Array(4).fill(stands));
  for (const contact of [still(true), still(false), sequence([0, 0.5, 0.25, 0.75], 2, 0.6, 50)]) {
    assert.equal(measureGait(contact, PERIOD, rules).label, rules.no_gait);
  }
  assert.ok(Number.isNaN(measureGait(still(true), PERIOD, rules).frequencyHz));
});

test('the distance from a gait is the mean over leg pairs', () => {
  // The hind pair a tenth of a stride late: the four pairs across front and hind are off by .1, the others by 0.
  close(phaseError([0.9, 0.4, 0.5, 0], [0, 0.5, 0.5, 0]), 0.4 / 6, 1e-12);
});

test('a short loss of contact is closed, a long one and one at an end stay', () => {
  const row = (text) => [...text].map((letter) => [letter === 'x', false, false, true]);
  const found = debounced(row('.xx..xx...xx.'), PERIOD, 0.05);
  assert.equal(found.map(([stands]) => (stands ? 'x' : '.')).join(''), '.xxxxxx...xx.');
  assert.ok(found.every((of) => of[3] && !of[1]));
});

test('a skill is a gait near its stride frequency', () => {
  assert.deepEqual(splitName('slow_trot_2.5hz'), { gait: 'slow_trot', frequencyHz: 2.5 });
  assert.deepEqual(splitName('trot'), { gait: 'trot', frequencyHz: null });
  const names = ['trot_2hz', 'trot_3hz', 'pace_2hz'];
  assert.equal(performed('trot', 2.2, names, rules), 'trot_2hz');
  assert.equal(performed('trot', 2.45, names, rules), null);
  assert.equal(performed('trot', 3.3, names, rules), 'trot_3hz');
  assert.equal(performed('pace', 3, names, rules), null);
  assert.equal(performed('pace', 9, ['trot', 'pace'], rules), 'pace');
});

test('the measure is that of camp.metrics', { skip: !golden && 'needs tests/test_web.py' }, (t) => {
  let largest = 0;
  const compare = (found, expected) => {
    if (expected === null || Number.isNaN(expected)) return assert.ok(Number.isNaN(found));
    largest = Math.max(largest, Math.abs(found - expected));
    return close(found, expected, 1e-6);
  };
  for (const { raw, debounced: closed, measured } of golden.gaits) {
    const contact = debounced(raw, PERIOD, rules.bounce_s);
    assert.deepEqual(contact, closed);
    const found = measureGait(contact, PERIOD, rules);
    assert.equal(found.label, measured.label);
    assert.deepEqual(found.stepping, measured.stepping);
    compare(found.frequencyHz, measured.frequency_hz);
    compare(found.flight, measured.flight_fraction);
    for (const key of ['phase', 'duty', 'rhythm']) {
      found[key].forEach((value, leg) => compare(value, measured[key][leg]));
    }
  }
  t.diagnostic(`${golden.gaits.length} sequences, largest difference ${largest.toExponential(1)}`);
});
