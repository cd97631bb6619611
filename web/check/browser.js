import { execFileSync } from 'node:child_process';
import { chromium } from 'playwright-core';

/** The path of Chromium: named by CHROMIUM, or found on the path. */
function findChromium() {
  const names = [process.env.CHROMIUM, 'chromium', 'chromium-browser', 'google-chrome'].filter(Boolean);
  for (const name of names) {
    try {
      return execFileSync('which', [name], { stdio: ['ignore', 'pipe', 'ignore'] }).toString().trim();
    } catch {
      continue;
    }
  }
  throw new Error(`no browser: install chromium or set CHROMIUM=<path> (looked for ${names.join(', ')})`);
}

/** A headless Chromium that draws without a graphics card, as root too. */
export function launch() {
  return chromium.launch({
    executablePath: findChromium(),
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
}

/** One page: what it complains of, and which hosts it asks. */
export class Visit {
  /** Open an address in a page of its own and wait for a selector, each wait up to `patience` ms. */
  static async open(browser, url, { settings, patience, ready }) {
    const page = await browser.newPage(settings);
    page.setDefaultTimeout(patience);
    const visit = new this(page);
    await page.goto(url);
    await page.waitForSelector(ready);
    return visit;
  }

  constructor(page) {
    this.page = page;
    this.errors = [];
    this.hosts = new Set();
    page.on('pageerror', (error) => this.errors.push(error.message));
    page.on('request', (request) => this.hosts.add(new URL(request.url()).host));
  }
}
