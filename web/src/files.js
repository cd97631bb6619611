/** The page's own files, beside index.html wherever it is served. */

/** The absolute address of a file: ONNX Runtime resolves relative ones against its own script. */
export const address = (name) => new URL(name, document.baseURI).href;

export async function text(name) {
  return (await answer(name)).text();
}

export async function json(name) {
  return (await answer(name)).json();
}

export async function bytes(name) {
  return new Uint8Array(await (await answer(name)).arrayBuffer());
}

async function answer(name) {
  const response = await fetch(address(name));
  if (!response.ok) throw new Error(`${name}: the server answers ${response.status}; run \`make web\` again`);
  return response;
}
