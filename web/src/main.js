import { Clock } from './clock.js';
import { Controls } from './controls.js';
import { Diagram } from './diagram.js';
import { loadEngines } from './engines.js';
import { bytes, json, text } from './files.js';
import { listenToKeys } from './keys.js';
import { Policy } from './policy.js';
import { Readout } from './readout.js';
import { Robot } from './robot.js';
import { Scene } from './scene.js';
import { splitName } from './skills.js';
import { Walker } from './walker.js';

const SLOW = 0.25; // simulated seconds per second in slow motion
const SHOWN_EVERY_MS = 100; // the numbers: faster could not be read

const page = Object.fromEntries([...document.querySelectorAll('[id]')].map((element) => [element.id, element]));

async function load() {
  const [{ mujoco, ort }, xml, metadata, rules, model] = await Promise.all([
    loadEngines(),
    text('robot.xml'),
    json('policy.json'),
    json('rules.json'),
    bytes('policy.onnx'),
  ]);
  const policy = await Policy.load(ort, model, metadata);
  return new Walker(new Robot(mujoco, xml, metadata, rules), policy, rules);
}

function start(walker) {
  const { robot, rules, metadata } = walker;
  page['gait-count'].textContent = new Set(metadata.skills.map((name) => splitName(name).gait)).size;
  page.panel.hidden = page.feet.hidden = false;
  const scene = new Scene(page.scene, robot);
  const clock = new Clock(robot.model.opt.timestep);
  const controls = new Controls(page, metadata, rules, (change) => Object.assign(walker, change));
  const actions = connectButtons(walker, scene, clock);
  listenToKeys(controls, actions);
  keepRobotInSight(scene);
  runForever(walker, scene, clock);
}

function connectButtons(walker, scene, clock) {
  let side = 1;
  let reset = false;
  const actions = {
    push() {
      const angle = walker.robot.heading() + (side * Math.PI) / 2; // from the left and the right in turn
      const [x, y] = [Math.cos(angle), Math.sin(angle)];
      walker.push(walker.rules.push_m_s * x, walker.rules.push_m_s * y);
      scene.showPush(x, y, performance.now());
      side = -side;
    },
    reset() {
      walker.reset();
      scene.reset();
    },
    pause() {
      clock.paused = !clock.paused;
      page.pause.setAttribute('aria-pressed', clock.paused);
      page.pause.firstElementChild.textContent = clock.paused ? 'Go on' : 'Pause';
    },
    slow() {
      clock.speed = clock.speed === 1 ? SLOW : 1;
      page.slow.setAttribute('aria-pressed', clock.speed !== 1);
    },
  };
  for (const [name, action] of Object.entries(actions)) page[name].addEventListener('click', action);
  return actions;
}

/** On wide screens the cards lie over the picture, on phones beside it. */
function keepRobotInSight(scene) {
  const place = () => {
    const over = getComputedStyle(page.panel).position === 'absolute';
    scene.uncover(over ? { left: page.panel.offsetWidth, bottom: page.feet.offsetHeight } : { left: 0, bottom: 0 });
  };
  window.addEventListener('resize', place);
  place();
}

function runForever(walker, scene, clock) {
  const diagram = new Diagram(page.diagram, walker.rules, walker.periodS);
  const readout = new Readout(page, walker.rules);
  let shown = -Infinity;
  async function frame(now) {
    await clock.advance(now, async () => {
      await walker.tick();
      scene.track();
    });
    scene.draw(now);
    const pushed = diagram.draw(walker.log);
    if (now - shown > SHOWN_EVERY_MS) {
      shown = now;
      readout.show(walker.measured, walker.skill, pushed);
      notify(walker.fallen ? 'The robot fell. Reset (R) stands it up.' : '');
    }
    requestAnimationFrame((next) => frame(next).catch(explain));
  }
  requestAnimationFrame((first) => frame(first).catch(explain));
}

function notify(message) {
  page.notice.hidden = message === '';
  page.notice.className = 'beside';
  if (page.notice.textContent !== message) page.notice.textContent = message;
}

function explain(error) {
  console.error(error);
  page.notice.hidden = false;
  page.notice.textContent = `This does not work here: ${error.message ?? error}`;
}

load().then(start).catch(explain);
