import { LEG_COLOURS } from './colours.js';

const SVG = 'http://www.w3.org/2000/svg'; // a name, not an address
const [WIDTH, LANE, STANCE] = [34, 6, 0.5]; // pixels, pixels, fraction of a stride

/** A gait's contact diagram of one stride in small: a bar in each leg's colour while it stands. phases: in strides. */
export function gaitIcon(phases) {
  const icon = element('svg', { width: WIDTH, height: 4 * LANE - 1, 'aria-hidden': true });
  phases.forEach((phase, leg) => {
    // The stance that begins before the stride's end goes on at its start.
    for (const begin of [phase, phase - 1]) {
      const [from, to] = [Math.max(0, begin), Math.min(1, begin + STANCE)];
      if (to <= from) continue;
      const place = { x: from * WIDTH, width: (to - from) * WIDTH, y: leg * LANE, height: LANE - 1 };
      icon.append(element('rect', { ...place, fill: LEG_COLOURS[leg] }));
    }
  });
  return icon;
}

function element(name, attributes) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}
