/**
 * Tries dist/ in a real browser: `make web-check`. Chromium is found on the path or named by CHROMIUM.
 *
 * Every gait is asked for by its button and must be measured from the page's contacts; the sliders, keys, push, reset
 * and pause must do what they say. Screenshots for looking at go to outputs/web/. No step depends on the clock: a slow
 * machine only takes longer.
 */
import assert from 'node:assert/strict';
import { existsSync, mkdirSync } from 'node:fs';
import { launch, Visit } from './browser.js';
import { serve } from './server.js';

const DIST = new URL('../dist', import.meta.url).pathname;
const SHOTS = new URL('../../outputs/web', import.meta.url).pathname;
const PATIENCE_MS = 300_000;
const SMALL = { width: 480, height: 300 }; // cheap to draw without a graphics card
const LEGS = [[0, 114, 178], [230, 159, 0], [0, 158, 115], [213, 94, 0]]; // their colours in the diagram
const PUSH = [178, 24, 43]; // the colour of its mark
const SIZES = {
  desktop: { viewport: { width: 1280, height: 720 } },
  phone: { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, isMobile: true, hasTouch: true },
};

/** One page with its waits. All that is read of it is what a person sees. */
class Walk extends Visit {
  static open(browser, url, settings) {
    return super.open(browser, url, { settings, patience: PATIENCE_MS, ready: '#panel:not([hidden])' });
  }

  constructor(page) {
    super(page);
    page.on('requestfailed', (request) => this.errors.push(`${request.url()}: not loaded`));
  }

  /** Press without waiting for animations to rest: they never do here. */
  press(selector) {
    return this.page.dispatchEvent(selector, 'click');
  }

  text(selector) {
    return this.page.textContent(selector);
  }

  async number(selector) {
    return Number(await this.text(selector));
  }

  until(condition, argument) {
    return this.page.waitForFunction(condition, argument, { polling: 200 });
  }

  measured(skill) {
    return this.until((name) => document.querySelector('#gait').dataset.skill === name, skill);
  }

  speedBeyond(least) {
    return this.until((value) => Number(document.querySelector('#speed').textContent) > value, least);
  }

  slide(place, value) {
    return this.page.locator('#sliders input').nth(place).fill(String(value));
  }

  /** How many of the diagram's pixels are of a colour, three numbers. */
  pixels(colour) {
    return this.page.evaluate((wanted) => {
      const canvas = document.querySelector('#diagram');
      const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
      let count = 0;
      for (let i = 0; i < data.length; i += 4) count += wanted.every((value, k) => data[i + k] === value);
      return count;
    }, colour);
  }
}

async function tryGaits(visit) {
  const skills = await visit.page.locator('#skills button').evaluateAll((all) => all.map((one) => one.dataset.skill));
  for (const skill of skills) {
    await visit.press(`[data-skill="${skill}"]`);
    await visit.measured(skill);
    console.log(`  ${skill}: ${await visit.text('#frequency')} strides per s, ${await visit.text('#speed')} m/s`);
    for (const leg of LEGS) assert.ok((await visit.pixels(leg)) > 100, 'each leg has bars in the diagram');
  }
  return skills;
}

async function trySliders(visit, skills) {
  await visit.press(`[data-skill="${skills[0]}"]`);
  await visit.slide(0, -0.3);
  await visit.until(() => Number(document.querySelector('#speed').textContent) < -0.15);
  await visit.slide(0, 0.6);
  await visit.speedBeyond(0.45);
  await visit.page.keyboard.press('3');
  assert.equal(await visit.page.getAttribute(`[data-skill="${skills[2]}"]`, 'aria-pressed'), 'true');
  await visit.measured(skills[2]);
  await visit.page.keyboard.press('x');
  assert.match(await visit.text('#sliders output'), /^0\.00 m\/s$/);
  console.log('  sliders and keys are followed');
}

async function tryButtons(visit, skills) {
  await visit.slide(0, 0.6);
  await visit.press(`[data-skill="${skills[0]}"]`);
  await visit.measured(skills[0]);
  assert.equal(await visit.pixels(PUSH), 0);
  await visit.press('#push');
  await visit.until(() => document.querySelector('#diagram').ariaLabel.includes('pushed'));
  assert.ok((await visit.pixels(PUSH)) > 50, 'the push is marked in the diagram');
  await visit.measured(skills[0]);
  await visit.press('#pause');
  assert.equal(await visit.page.getAttribute('#pause', 'aria-pressed'), 'true');
  await visit.press('#reset');
  await visit.until(() => document.querySelector('#gait').dataset.skill === '');
  await visit.press('#pause');
  await visit.measured(skills[0]);
  console.log('  push, pause and reset work');
}

/** A picture of a gait in full size, after a switch and a push. */
async function shoot(browser, url, name, skills) {
  const other = skills[Math.floor(skills.length / 2)];
  const { viewport, ...device } = SIZES[name];
  const visit = await Walk.open(browser, url, { viewport: SMALL, ...device });
  await visit.measured(skills[0]);
  await visit.press(`[data-skill="${other}"]`);
  await visit.measured(other);
  await visit.press('#push');
  await visit.until(() => document.querySelector('#diagram').ariaLabel.includes('pushed'));
  await visit.press('#pause'); // so that switch and push are still in the diagram when the picture is taken
  await visit.page.setViewportSize(viewport);
  assert.ok(await visit.page.evaluate(() => document.body.scrollWidth <= innerWidth), 'nothing is cut off');
  await visit.page.screenshot({ path: `${SHOTS}/${name}.png`, timeout: PATIENCE_MS });
  console.log(`  outputs/web/${name}.png`);
  await (device.hasTouch ? visit.page.tap('#pause', { force: true }) : visit.page.click('#pause', { force: true }));
  assert.equal(await visit.page.getAttribute('#pause', 'aria-pressed'), 'false');
  await visit.page.close();
}

async function main() {
  if (!existsSync(DIST)) throw new Error('web/dist is not there: run `make web` first');
  mkdirSync(SHOTS, { recursive: true });
  const server = await serve(DIST, 'camp');
  const browser = await launch();
  try {
    const visit = await Walk.open(browser, server.url, { viewport: SMALL });
    const skills = await tryGaits(visit);
    await trySliders(visit, skills);
    await tryButtons(visit, skills);
    assert.deepEqual(visit.errors, []);
    assert.deepEqual([...visit.hosts].filter((host) => host !== new URL(server.url).host), [], 'no other host');
    await visit.page.close();
    for (const name of Object.keys(SIZES)) await shoot(browser, server.url, name, skills);
    console.log('the page works');
  } finally {
    await browser.close();
    server.close();
  }
}

main().catch((error) => {
  console.error(`error: ${error.message}`);
  process.exitCode = 1;
});
