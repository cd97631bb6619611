/**
 * Tries the page of `python -m camp.play` in a real browser: `node web/check/play.js <address> <folder of screenshots>`.
 * tests/play/test_browser.py starts both.
 *
 * Skills are asked for by their buttons and must be measured from the contacts; keys, sliders, push, reset and pause
 * must do what they say. No step depends on the clock: a slow machine only takes longer.
 */
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import { launch, Visit } from './browser.js';

const PATIENCE_MS = 300_000;
const SMALL = { width: 800, height: 440 }; // cheap to draw without a graphics card
const LARGE = { width: 1280, height: 720 };

/** The page with its waits. All that is read of it is what a person sees. */
class Play extends Visit {
  static open(browser, url) {
    return super.open(browser, url, { settings: { viewport: SMALL }, patience: PATIENCE_MS, ready: '#readout' });
  }

  /** Wait until the readout's data-<name> passes a test, a function's text. */
  until(name, passes) {
    const expression = `(${passes})(document.querySelector('#readout').dataset.${name})`;
    return this.page.waitForFunction(expression, undefined, { polling: 200 });
  }

  measured(skill) {
    return this.until('skill', `(value) => value === '${skill}'`);
  }

  press(text) {
    return this.page.getByRole('button', { name: text }).first().dispatchEvent('click');
  }

  key(name) {
    return this.page.keyboard.press(name);
  }

  read(name) {
    return this.page.getAttribute('#readout', `data-${name}`);
  }
}

async function main() {
  const [url, shots] = process.argv.slice(2);
  mkdirSync(shots, { recursive: true });
  const browser = await launch();
  try {
    const visit = await Play.open(browser, url);
    await visit.measured('trot_2hz');
    await visit.press('Pace, 3 strides/s');
    await visit.measured('pace_3hz');
    console.log(`a button: pace_3hz, ${await visit.read('frequency')} strides per s, ${await visit.read('vx')} m/s`);
    await visit.key('8');
    await visit.measured('bound_3hz');
    console.log(`a key: bound_3hz, ${await visit.read('frequency')} strides per s, ${await visit.read('vx')} m/s`);
    for (let step = 0; step < 6; step++) await visit.key('ArrowDown');
    await visit.until('vx', '(value) => Number(value) < 0.45');
    console.log('the arrow keys slow it down');
    await visit.key('p');
    await visit.until('pushes', '(value) => Number(value) === 1');
    console.log('it is pushed');
    await visit.key('Space');
    await visit.until('state', "(value) => value === 'paused'");
    await visit.page.locator('.mantine-Notification-closeButton').first().dispatchEvent('click'); // of slow graphics
    await visit.page.setViewportSize(LARGE);
    await visit.page.screenshot({ path: `${shots}/play.png`, timeout: PATIENCE_MS });
    await visit.page.setViewportSize(SMALL);
    await visit.press('Reset');
    await visit.until('skill', "(value) => value === 'none'");
    await visit.press('Go on');
    await visit.measured('bound_3hz');
    console.log('pause and reset work');
    assert.deepEqual(visit.errors, []);
    const others = [...visit.hosts].filter((host) => host !== '' && host !== new URL(url).host);
    assert.deepEqual(others, [], 'no other host is asked');
    console.log('the page works');
  } finally {
    await browser.close();
  }
}

main().catch((error) => {
  console.error(`error: ${error.message}`);
  process.exitCode = 1;
});
