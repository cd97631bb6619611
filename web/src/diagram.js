import { LEG_COLOURS, PUSH_COLOUR } from './colours.js';
import { debounced } from './contacts.js';
import { splitName } from './skills.js';
import { spoken } from './words.js';

const ASKED = '#5b6875';
const INK = '#17212b';
const RIGHT = '#17212b'; // measured as asked for
const OTHER = '#a9b4bf';
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

  /** Returns whether the robot was pushed in the time that is shown. log: WalkLog. */
  draw(log) {
    const { width, height, pen } = this.prepare();
    const wide = width > 520;
    const seconds = wide ? 4 : 2.5;
    const left = wide ? 128 : 76;
    const space = { left, width: width - left, rows: Math.round(seconds / this.periodS) };
    const lane = (height - 18) / 6;
    this.font = `600 ${Math.min(12, Math.round(lane - 4))}px system-ui, "DejaVu Sans", sans-serif`;
    const rows = log.latest(space.rows);
    const contact = debounced(rows.map((row) => row.contact), this.periodS, this.rules.bounce_s); // as is measured
    const asked = rows.map((row) => splitName(row.skill).gait);
    const measured = rows.map((row) => row.gait);
    this.drawName(pen, 'Asked for', 0, lane, 0);
    this.drawGaits(pen, space, 0, lane, asked.map((gait) => [gait, ASKED]));
    this.drawName(pen, 'Measured', lane, lane, 0);
    const verdict = measured.map((gait, row) => [gait, gait === asked[row] ? RIGHT : OTHER]);
    this.drawGaits(pen, space, lane, lane, verdict);
    this.rules.feet.forEach((leg, i) => {
      const top = (i + 2) * lane;
      pen.fillStyle = LEG_COLOURS[i];
      pen.fillRect(0, top + 2, 12, lane - 4);
      this.drawName(pen, wide ? `${leg}  ${legName(leg)}` : leg, top, lane, 18);
      this.drawLane(pen, space, top, lane);
      pen.fillStyle = LEG_COLOURS[i];
      for (const [begin, end] of runs(contact.map((row) => row[i]))) {
        this.drawBar(pen, space, top, lane, begin - rows.length, end - rows.length);
      }
    });
    const pushes = rows.flatMap((row, i) => (row.pushed ? [i] : []));
    this.drawAxis(pen, space, seconds, height);
    pushes.forEach((row) => this.drawPush(pen, space, row - rows.length, 6 * lane));
    return pushes.length > 0;
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

  /** rows: [gait, colour] of each. */
  drawGaits(pen, space, top, lane, rows) {
    this.drawLane(pen, space, top, lane);
    for (const [begin, end] of runs(rows.map(String))) {
      const [gait, colour] = rows[begin];
      if (gait === this.rules.no_gait) continue;
      pen.fillStyle = colour;
      const [x, width] = this.drawBar(pen, space, top, lane, begin - rows.length, end - rows.length);
      if (width < 56) continue;
      pen.fillStyle = '#fff';
      pen.font = this.font;
      pen.fillText(spoken(gait), x + 6, top + lane / 2 + 1);
    }
  }

  drawName(pen, name, top, lane, x) {
    pen.fillStyle = INK;
    pen.font = this.font;
    pen.fillText(name, x, top + lane / 2 + 1);
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

  drawPush(pen, { left, width, rows }, row, bottom) {
    const x = left + (1 + row / rows) * width;
    pen.fillStyle = '#fff';
    pen.fillRect(x - 24, bottom + 2, 48, 16); // over the axis' own labels
    pen.fillStyle = PUSH_COLOUR;
    pen.fillRect(x, 0, 3, bottom);
    pen.font = '600 11px system-ui, "DejaVu Sans", sans-serif';
    pen.textAlign = 'center';
    pen.fillText('push', x, bottom + 11);
    pen.textAlign = 'left';
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
