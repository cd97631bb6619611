import * as THREE from 'three';
import { LEG_COLOURS } from './colours.js';

const KEPT = 40; // prints of each foot
const RADIUS = 0.026; // m

/** Where the feet touched down, as discs on the floor that shrink with age, and a ring round each foot that stands. */
export class Footprints {
  /** robot: Robot. */
  constructor(robot) {
    this.robot = robot;
    this.group = new THREE.Group();
    this.legs = LEG_COLOURS.map((colour) => new LegPrints(colour));
    this.group.add(...this.legs.flatMap((leg) => [leg.discs, leg.ring]));
  }

  clear() {
    this.legs.forEach((leg) => leg.clear());
  }

  /** Take over which feet stand now, and where. */
  update() {
    const standing = this.robot.contacts();
    const { geom_xpos: position } = this.robot.data;
    this.legs.forEach((leg, i) => {
      const at = 3 * this.robot.feet[i];
      leg.update(standing[i], position[at], position[at + 1]);
    });
  }
}

class LegPrints {
  constructor(colour) {
    const faint = new THREE.MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.55, depthWrite: false });
    this.discs = new THREE.InstancedMesh(new THREE.CircleGeometry(RADIUS, 24), faint, KEPT);
    this.discs.frustumCulled = false;
    const strong = new THREE.MeshBasicMaterial({ color: colour, depthWrite: false });
    this.ring = new THREE.Mesh(new THREE.RingGeometry(1.35 * RADIUS, 1.9 * RADIUS, 36), strong);
    this.clear();
  }

  clear() {
    this.places = [];
    this.lastPlace = null;
    this.draw();
    this.ring.visible = false;
  }

  update(stands, x, y) {
    this.ring.visible = stands;
    this.ring.position.set(x, y, 0.004);
    if (!stands) return;
    // A stance that bounces, or slides a little, is one print.
    if (this.lastPlace && Math.hypot(x - this.lastPlace[0], y - this.lastPlace[1]) < RADIUS) return;
    this.lastPlace = [x, y];
    this.places.unshift(this.lastPlace);
    this.places.length = Math.min(this.places.length, KEPT);
    this.draw();
  }

  draw() {
    const matrix = new THREE.Matrix4();
    for (let i = 0; i < KEPT; i++) {
      const size = i < this.places.length ? 1 - (0.8 * i) / KEPT : 0;
      const [x, y] = this.places[i] ?? [0, 0];
      matrix.makeScale(size, size, size).setPosition(x, y, 0.003);
      this.discs.setMatrixAt(i, matrix);
    }
    this.discs.instanceMatrix.needsUpdate = true;
  }
}
