/** Writes dist/: the page, its code in one file, the engines' WebAssembly and the inputs of public/. */
import { build } from 'esbuild';
import { cp, mkdir, rm } from 'node:fs/promises';

const at = (path) => new URL(path, import.meta.url).pathname;
const PACKAGES = {
  'node_modules/@mujoco/mujoco/mujoco.wasm': 'mujoco.wasm',
  'node_modules/onnxruntime-web/dist/ort-wasm-simd-threaded.mjs': 'ort/ort-wasm-simd-threaded.mjs',
  'node_modules/onnxruntime-web/dist/ort-wasm-simd-threaded.wasm': 'ort/ort-wasm-simd-threaded.wasm',
};
const PAGE = { 'index.html': 'index.html', 'style.css': 'style.css', public: '.' };

await rm(at('dist'), { recursive: true, force: true });
await mkdir(at('dist/ort'), { recursive: true });
await build({
  entryPoints: [at('src/main.js')],
  outfile: at('dist/main.js'),
  bundle: true,
  format: 'esm',
  target: 'es2022',
  minify: true,
  legalComments: 'linked',
  // ONNX Runtime's code without its WebAssembly, which is fetched from wasmPaths.
  conditions: ['onnxruntime-web-use-extern-wasm'],
  external: ['module'], // of Node, which MuJoCo's loader asks for there only
  logLevel: 'warning',
});
for (const [from, to] of Object.entries({ ...PACKAGES, ...PAGE })) {
  await cp(at(from), at(`dist/${to}`), { recursive: true });
}
