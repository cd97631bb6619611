/** The page's files and engines in Node. CAMP_WEB_INPUTS names another folder of files than `make web` fills. */
import loadMujoco from '@mujoco/mujoco';
import { existsSync, readFileSync } from 'node:fs';
import * as ort from 'onnxruntime-web/wasm';
import { Policy } from '../src/policy.js';
import { Robot } from '../src/robot.js';
import { Walker } from '../src/walker.js';

const folder = process.env.CAMP_WEB_INPUTS ?? new URL('../public', import.meta.url).pathname;

export const read = (name) => readFileSync(`${folder}/${name}`);
export const readJson = (name) => JSON.parse(read(name));
export const rules = readJson('rules.json');
export const metadata = readJson('policy.json');

/** What Python answers to the same input (tests/test_web.py writes it); null outside of that test. */
export const golden = existsSync(`${folder}/golden.json`) ? readJson('golden.json') : null;

export async function newRobot(described = metadata) {
  return new Robot(await loadMujoco(), read('robot.xml').toString(), described, rules);
}

export async function newWalker() {
  ort.env.wasm.numThreads = 1;
  const policy = await Policy.load(ort, new Uint8Array(read('policy.onnx')), metadata);
  return new Walker(await newRobot(), policy, rules);
}
