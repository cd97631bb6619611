import * as THREE from 'three';

const EXTENT = 30; // m
const PIXELS = 512; // of the texture of one tile, 1 m wide

/** A floor of square metres, quarters marked. anisotropy: how sharp it is far away. */
export function newFloor(anisotropy) {
  const texture = new THREE.CanvasTexture(tile());
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.repeat.set(EXTENT, EXTENT);
  texture.anisotropy = anisotropy;
  const material = new THREE.MeshLambertMaterial({ map: texture }); // cheap: it covers most of the picture
  const floor = new THREE.Mesh(new THREE.PlaneGeometry(EXTENT, EXTENT), material);
  floor.receiveShadow = true;
  return floor;
}

function tile() {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = PIXELS;
  const pen = canvas.getContext('2d');
  pen.fillStyle = '#d3dbe3';
  pen.fillRect(0, 0, PIXELS, PIXELS);
  pen.fillStyle = '#c2ccd6';
  for (const quarter of [1, 2, 3]) {
    const at = (quarter * PIXELS) / 4 - 1;
    pen.fillRect(at, 0, 2, PIXELS);
    pen.fillRect(0, at, PIXELS, 2);
  }
  pen.fillStyle = '#a3b0bd';
  pen.fillRect(0, 0, PIXELS, 5);
  pen.fillRect(0, 0, 5, PIXELS);
  return canvas;
}
