import { gaitColour, LEG_COLOURS } from './colours.js';
import { splitName } from './skills.js';
import { spoken } from './words.js';

const INK = '#17212b';
const FAINT = '#5b6875';
const LANE = '#e6ebf0';
const NAMES = { F: 'front', R: 'rear', L: 'left' };

/** The contact diagram: when each foot stood, and above it the gait that was asked for and the one measured. */
export class Diagram {
  constructor(canvas, rules, periodS) {
    this.canvas = canvas;
    this.rules = rules;
    this.periodS = periodS;
  }

  /** log: WalkLog. */
  draw(log) {
    const { width, height, pen } = this.prepare();
    const wide = width > 520;
    const seconds = wide ? 4 : 2.5;
    const left = wide ? 112 : 64;
    const space = { left, width: width - left, rows: Math.round(seconds / this.periodS) };
    const lane = (height - 18) / 6;
    const rows = log.latest(space.rows);
    this.drawGaits(pen, rows.map((row) => splitName(row.skill).gait), { ...space, top: 0, lane, name: 'Asked for' });
    this.drawGaits(pen, rows.map((row) => row.gait), { ...space, top: lane, lane, name: 'Measured' });
    this.rules.feet.forEach((leg, i) => {
      const top = (i + 2) * lane;
      this.drawName(pen, wide ? `${leg}  ${legName(leg)}` : leg, top, lane, LEG_COLOURS[i]);
      this.drawLane(pen, space, top, lane);
      pen.fillStyle = LEG_COLOURS[i];
      for (const [begin, end] of runs(rows.map((row) => row.contact[i]))) {
        this.drawBar(pen, space, top, lane, begin - rows.length, end - rows.length);
      }
    });
    this.drawAxis(pen, space, seconds, height);
  }

  prepare() {
    const { canvas } = this;
    const ratio = Math.min(window.devicePixelRatio, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    const pen = canvas.getContext('2d');
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.textBaseline = 'middle';
    return { width, height, pen };
  }

  drawGaits(pen, gaits, { top, lane, name, ...space }) {
    this.drawName(pen, name, top, lane, FAINT);
    this.drawLane(pen, space, top, lane);
    for (const [begin, end] of runs(gaits)) {
      const gait = gaits[begin];
      if (gait === this.rules.no_gait) continue;
      pen.fillStyle = gaitColour(gait, this.rules);
      const [x, width] = this.drawBar(pen, space, top, lane, begin - gaits.length, end - gaits.length);
      if (width < 56) continue;
      pen.fillStyle = INK;
      pen.font = '600 12px system-ui, "DejaVu Sans", sans-serif';
      pen.fillText(spoken(gait), x + 6, top + lane / 2);
    }
  }

  drawName(pen, name, top, lane, colour) {
    pen.fillStyle = colour;
    pen.font = '600 12px system-ui, "DejaVu Sans", sans-serif';
    pen.fillText(name, 0, top + lane / 2);
  }

  drawLane(pen, space, top, lane) {
    pen.fillStyle = LANE;
    pen.fillRect(space.left, top + 2, space.width, lane - 4);
  }

  /** From row `begin` to before row `end`, counted from now backwards: -1 is the latest. */
  drawBar(pen, { left, width, rows }, top, lane, begin, end) {
    const x = left + (1 + begin / rows) * width;
    const wide = ((end - begin) / rows) * width;
    pen.fillRect(x, top + 2, wide, lane - 4);
    return [x, wide];
  }

  drawAxis(pen, { left, width }, seconds, height) {
    pen.fillStyle = FAINT;
    pen.font = '11px system-ui, "DejaVu Sans", sans-serif';
    for (let ago = 0; ago <= seconds; ago++) {
      const label = ago === 0 ? 'now' : `${ago} s ago`;
      pen.textAlign = ago === 0 ? 'right' : ago === seconds ? 'left' : 'center';
      pen.fillText(label, left + width * (1 - ago / seconds), height - 7);
    }
    pen.textAlign = 'left';
  }
}

/** Begin and end (exclusive) of each stretch of equal values that are not false. */
export function runs(values) {
  const found = [];
  let begin = 0;
  for (let i = 1; i <= values.length; i++) {
    if (i < values.length && values[i] === values[begin]) continue;
    if (values[begin] !== false) found.push([begin, i]);
    begin = i;
  }
  return values.length ? found : [];
}

/** "FL" -> "front left"; a leg of another name stays as it is. */
function legName(leg) {
  const [end, side] = [NAMES[leg[0]], leg[1] === 'R' ? 'right' : NAMES[leg[1]]];
  return end && side ? `${end} ${side}` : '';
}
