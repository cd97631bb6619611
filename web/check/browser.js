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
