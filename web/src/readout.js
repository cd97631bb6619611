import { spoken } from './words.js';

/** The measured gait, stride frequency and speed in words and numbers. */
export class Readout {
  /** page: the elements gait, frequency, speed and diagram. */
  constructor(page, rules) {
    this.page = page;
    this.rules = rules;
  }

  /** measured: Walker.measured; skill: the name of the one asked for; pushed: whether lately. */
  show(measured, skill, pushed) {
    const { page } = this;
    const known = measured.gait !== this.rules.no_gait;
    const right = measured.skill === skill;
    const frequency = Number.isFinite(measured.frequencyHz) ? measured.frequencyHz.toFixed(2) : '–';
    const speed = measured.velocity ? measured.velocity[0].toFixed(2) : '–';
    const verdict = !known ? '' : right ? '✓ as asked' : 'not (yet) as asked';
    write(page.gait, known ? spoken(measured.gait) : 'none', verdict, right ? '#00704f' : '#a34400');
    page.gait.dataset.skill = measured.skill ?? '';
    page.frequency.textContent = frequency;
    page.speed.textContent = speed;
    const push = pushed ? ', pushed' : '';
    page.diagram.ariaLabel = `Contact diagram. Measured: ${measured.gait}, ${frequency} strides per second${push}`;
  }
}

function write(element, text, note, colour) {
  if (element.dataset.text === text + note) return;
  element.dataset.text = text + note;
  element.replaceChildren(text, Object.assign(document.createElement('small'), { textContent: note }));
  element.lastChild.style.color = colour;
}
