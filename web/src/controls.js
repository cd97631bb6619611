import { gaitIcon } from './icon.js';
import { splitName } from './skills.js';
import { COMMANDS, commandText, spoken } from './words.js';

const STEP = 0.05; // of the sliders, in the command's unit
const START = 2 / 3; // of the fastest forward

/** Buttons of the skills, sliders of the command. `change({skill})` or `change({command})` is called on each change. */
export class Controls {
  constructor(page, metadata, rules, change) {
    this.page = page;
    this.metadata = metadata;
    this.change = change;
    this.buttons = metadata.skills.map((name) => this.newSkill(name, rules));
    page.skills.style.setProperty('--rates', new Set(metadata.skills.map((name) => splitName(name).frequencyHz)).size);
    this.sliders = Object.entries(metadata.command_range).map(([name, range]) => this.newSlider(COMMANDS[name], range));
    this.choose(0);
    this.set(0, this.sliders[0].max * START);
  }

  /** Ask for the skill of a place in the policy's list; a place beyond its end is left alone. */
  choose(place) {
    if (place >= this.buttons.length) return;
    this.buttons.forEach((button, i) => button.setAttribute('aria-pressed', i === place));
    this.change({ skill: this.metadata.skills[place] });
  }

  /** Add so many steps to a command: 0 forward, 1 to the left, 2 turning to the left. */
  nudge(axis, steps) {
    this.set(axis, Number(this.sliders[axis].value) + steps * STEP);
  }

  /** Ask the robot to stand still. */
  halt() {
    this.sliders.forEach((_, axis) => this.set(axis, 0));
  }

  set(axis, value) {
    this.sliders[axis].value = value; // the browser keeps it within the range
    this.sliders[axis].dispatchEvent(new Event('input'));
  }

  newSkill(name, rules) {
    const { gait, frequencyHz } = splitName(name);
    const button = document.createElement('button');
    button.type = 'button';
    button.dataset.skill = name;
    const phases = rules.gaits.find((known) => known.name === gait)?.phases;
    const text = Object.assign(document.createElement('span'), { textContent: spoken(gait) });
    if (frequencyHz !== null) {
      text.append(Object.assign(document.createElement('small'), { textContent: `${frequencyHz} Hz` }));
    }
    button.append(text, ...(phases ? [gaitIcon(phases)] : []));
    button.addEventListener('click', () => this.choose(this.metadata.skills.indexOf(name)));
    this.page.skills.append(button);
    return button;
  }

  newSlider(words, [min, max]) {
    const label = document.createElement('label');
    const output = document.createElement('output');
    const slider = Object.assign(document.createElement('input'), { type: 'range', min, max, step: STEP, value: 0 });
    slider.addEventListener('input', () => {
      output.textContent = commandText(Number(slider.value), words);
      this.change({ command: this.sliders.map(({ value }) => Number(value)) });
    });
    output.textContent = commandText(0, words);
    label.append(words.title, output, slider);
    this.page.sliders.append(label);
    return slider;
  }
}
