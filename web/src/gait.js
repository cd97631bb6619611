/**
 * Foot contacts -> stride frequency, leg phases, duty and the gait's name: camp.metrics.gait for one sequence.
 *
 * Every foot's contact signal is a rectangular wave. Its fundamental carries the rhythm and the timing of the leg, its
 * mean over whole strides the duty. All thresholds come from rules.json.
 */

const TURN = 2 * Math.PI;

/**
 * contact: T rows of four booleans, T >= 4; periodS: time between rows. Returns {frequencyHz, phase, duty, flight,
 * rhythm, stepping, label}: phase, duty, rhythm and stepping by leg, NaN where a foot does not step.
 */
export function measureGait(contact, periodS, rules) {
  const segments = cut(contact, periodS, rules.segment_s);
  const frequency = refine(segments, coarseFrequency(segments, periodS, rules), periodS, rules);
  const cycles = frequency * periodS; // strides per row
  const weight = wholeStrides(segments[0].length, cycles);

  const duty = legs((leg) => mean(segments.map((rows) => weighted(rows, weight, (row) => row[leg]))));
  const flight = mean(segments.map((rows) => weighted(rows, weight, (row) => !row.some(Boolean))));
  const phasors = segments.map((rows) => legs((leg) => phasor(rows, weight, cycles, leg)));
  const rhythm = legs((leg) => rhythmOf(mean(phasors.map((of) => Math.hypot(...of[leg]))), duty[leg]));
  const wholeStride = segments[0].length * cycles >= 1;
  const stepping = legs(
    (leg) =>
      wholeStride &&
      rhythm[leg] >= rules.rhythm_min &&
      duty[leg] > rules.duty_range[0] &&
      duty[leg] < rules.duty_range[1],
  );
  const phase = legs((leg) => modulo(angle(sum(phasors.map((of) => timesConjugate(of[0], of[leg])))) / TURN));
  return {
    frequencyHz: stepping.some(Boolean) ? frequency : NaN,
    phase: legs((leg) => (stepping[0] && stepping[leg] ? phase[leg] : NaN)),
    duty,
    flight,
    rhythm,
    stepping,
    label: stepping.every(Boolean) ? labelOf(phase, rules) : rules.no_gait,
  };
}

/** Mean distance of the six leg pairs from a gait's timing, in strides. */
export function phaseError(phase, offsets) {
  const late = legs((leg) => phase[leg] - offsets[leg]);
  const pairs = late.flatMap((one, i) => late.slice(i + 1).map((other) => one - other));
  return mean(pairs.map((between) => Math.abs(between - Math.round(between))));
}

function labelOf(phase, rules) {
  const errors = rules.gaits.map((gait) => phaseError(phase, gait.phases));
  const least = Math.min(...errors);
  return least <= rules.phase_tolerance ? rules.gaits[errors.indexOf(least)].name : rules.no_gait;
}

/** Equal parts of about segmentS, so that a drifting stride rate does not count as none. */
function cut(contact, periodS, segmentS) {
  const count = Math.max(1, roundHalfEven((contact.length * periodS) / segmentS));
  const length = Math.floor(contact.length / count);
  return Array.from({ length: count }, (_, i) => contact.slice(i * length, (i + 1) * length));
}

/** Peak of the Hann-windowed power, summed over feet and segments, Hz. */
function coarseFrequency(segments, periodS, rules) {
  const length = segments[0].length;
  const hann = Array.from({ length }, (_, i) => 0.5 - 0.5 * Math.cos((TURN * (i + 1)) / (length + 1)));
  const total = sum(hann.map((value) => [value, 0]))[0];
  const signals = segments.flatMap((rows) =>
    legs((leg) => {
      const centre = weighted(rows, hann, (row) => row[leg]) / total;
      return rows.map((row, i) => (Number(row[leg]) - centre) * hann[i]);
    }),
  );
  const [low, high] = rules.frequency_range_hz;
  const step = rules.frequency_step_hz;
  const grid = [];
  for (let i = 0; low + i * step < high + step / 2; i++) grid.push(low + i * step);
  const power = grid.map((hertz) => spectralPower(signals, hertz * periodS));
  const peak = Math.min(grid.length - 2, Math.max(1, power.indexOf(Math.max(...power))));
  const [left, middle, right] = power.slice(peak - 1, peak + 2);
  const curvature = left - 2 * middle + right;
  const offset = curvature < 0 ? (left - right) / (2 * curvature) : 0;
  return grid[peak] + Math.min(1, Math.max(-1, offset)) * step;
}

function spectralPower(signals, cycles) {
  const turns = signals[0].map((_, i) => [Math.cos(TURN * cycles * i), Math.sin(TURN * cycles * i)]);
  let power = 0;
  for (const signal of signals) {
    const [real, imaginary] = sum(signal.map((value, i) => [value * turns[i][0], value * turns[i][1]]));
    power += real * real + imaginary * imaginary;
  }
  return power;
}

/** Correct the frequency by the feet's phase advance from the first to the last whole strides. */
function refine(segments, coarse, periodS, rules) {
  const length = segments[0].length;
  const [low, high] = rules.frequency_range_hz;
  let frequency = coarse;
  for (let round = 0; round < 3; round++) {
    const cycles = frequency * periodS;
    const strides = Math.max(1, Math.floor((length * cycles) / 2));
    const first = window(length, strides / cycles);
    const last = [...first].reverse();
    const drift = sum(
      segments.flatMap((rows) =>
        legs((leg) => timesConjugate(phasor(rows, last, cycles, leg), phasor(rows, first, cycles, leg))),
      ),
    );
    const gapS = Math.max(length - strides / cycles, 1) * periodS;
    frequency = Math.min(high, Math.max(low, frequency + angle(drift) / (TURN * gapS)));
  }
  return frequency;
}

/** Weights summing to 1 over the first `width` rows, the last row by its fraction. */
function window(length, width) {
  const weight = Array.from({ length }, (_, i) => Math.min(1, Math.max(0, width - i)));
  const total = weight.reduce((a, b) => a + b, 0);
  return weight.map((value) => value / total);
}

function wholeStrides(length, cycles) {
  return window(length, Math.max(1, Math.floor(length * cycles)) / cycles);
}

/** Fourier coefficient [real, imaginary] of a foot at `cycles` strides per row. */
function phasor(rows, weight, cycles, leg) {
  let [real, imaginary] = [0, 0];
  rows.forEach((row, i) => {
    if (!row[leg]) return;
    real += weight[i] * Math.cos(TURN * cycles * i);
    imaginary -= weight[i] * Math.sin(TURN * cycles * i);
  });
  return [real, imaginary];
}

/** Amplitude over sin(pi duty) / pi, the fundamental of a rectangular wave of that duty, at most 1. */
function rhythmOf(amplitude, duty) {
  const regular = Math.sin(Math.PI * Math.min(1, Math.max(0, duty))) / Math.PI;
  return regular > 1e-3 ? Math.min(1, amplitude / regular) : 0;
}

function weighted(rows, weight, value) {
  return rows.reduce((total, row, i) => total + weight[i] * Number(value(row)), 0);
}

/** a times the conjugate of b, as [real, imaginary]. */
function timesConjugate([a, b], [c, d]) {
  return [a * c + b * d, b * c - a * d];
}

function sum(pairs) {
  return pairs.reduce(([a, b], [c, d]) => [a + c, b + d], [0, 0]);
}

function mean(values) {
  return values.reduce((a, b) => a + b, 0) / values.length;
}

function legs(value) {
  return [0, 1, 2, 3].map(value);
}

function angle([real, imaginary]) {
  return Math.atan2(imaginary, real);
}

/** Into [0, 1); the remainder of a tiny negative number rounds up to 1, which is 0 here. */
function modulo(value) {
  const rest = value - Math.floor(value);
  return rest === 1 ? 0 : rest;
}

/** As Python rounds: halves to the even neighbour. */
function roundHalfEven(value) {
  const rounded = Math.round(value);
  return rounded - value === 0.5 && rounded % 2 ? rounded - 1 : rounded;
}
