import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { PUSH_COLOUR } from './colours.js';
import { newFloor } from './floor.js';
import { Footprints } from './footprints.js';
import { RobotMesh } from './robot_mesh.js';

const SKY = '#dfe6ee';
const SUN = new THREE.Vector3(-1.2, -1.6, 3.2); // from the robot to the light, m
const EYE = new THREE.Vector3(0.76, -1.3, 0.5); // from the robot to the camera at the start, m
const LOOK_HEIGHT = 0.2; // m
const ARROW_S = 0.6; // that a push is shown

/** The picture: robot, floor, light and camera, which go along with the robot. */
export class Scene {
  /** canvas: filled to the size of its parent; robot: Robot. */
  constructor(canvas, robot) {
    THREE.Object3D.DEFAULT_UP.set(0, 0, 1);
    this.robot = robot;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.renderer.shadowMap.enabled = true;
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(SKY);
    this.scene.fog = new THREE.Fog(SKY, 3.5, 11);
    this.mesh = new RobotMesh(robot);
    this.prints = new Footprints(robot);
    this.floor = newFloor(this.renderer.capabilities.getMaxAnisotropy());
    this.arrow = new THREE.ArrowHelper(new THREE.Vector3(0, 1, 0), new THREE.Vector3(), 0.5, PUSH_COLOUR, 0.14, 0.1);
    this.arrow.visible = false;
    this.scene.add(this.floor, this.mesh.group, this.prints.group, this.arrow);
    this.addLight();
    this.addCamera(canvas);
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  addLight() {
    this.scene.add(new THREE.HemisphereLight('#f4f8ff', '#aeb5bd', 1.9));
    this.sun = new THREE.DirectionalLight('#fff6e8', 1.9);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    this.sun.shadow.radius = 3;
    this.sun.shadow.normalBias = 0.01;
    Object.assign(this.sun.shadow.camera, { left: -0.9, right: 0.9, top: 0.9, bottom: -0.9, near: 1, far: 6 });
    this.scene.add(this.sun, this.sun.target);
  }

  addCamera(canvas) {
    this.target = new THREE.Vector3(0, 0, LOOK_HEIGHT);
    this.camera = new THREE.PerspectiveCamera(38, 1, 0.05, 30);
    this.camera.position.copy(this.target).add(EYE);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.target.copy(this.target);
    Object.assign(this.orbit, { enablePan: false, minDistance: 0.6, maxDistance: 4, maxPolarAngle: 1.54 });
  }

  /** Keep the robot in the middle of the part that cards do not cover. covered: {left, bottom} in pixels. */
  uncover(covered) {
    this.covered = covered;
    this.resize();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.renderer.domElement.parentElement;
    if (!width || !height) return;
    const { left, bottom } = this.covered ?? { left: 0, bottom: 0 };
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.setViewOffset(width, height, -left / 2, bottom / 2, width, height);
    this.camera.updateProjectionMatrix();
  }

  /** Show a push along (x, y) for a moment. now: ms. */
  showPush(x, y, now) {
    this.pushed = { direction: new THREE.Vector3(x, y, 0).normalize(), until: now + 1000 * ARROW_S };
  }

  /** Put camera and footprints back to the start. */
  reset() {
    this.prints.clear();
    this.follow();
  }

  /** Note the footprints; to be called at each physics timestep, lest one is missed between two pictures. */
  track() {
    this.prints.update();
  }

  /** Draw what the simulation holds. now: ms. */
  draw(now) {
    this.mesh.update();
    this.follow();
    this.placeArrow(now);
    this.orbit.update();
    this.renderer.render(this.scene, this.camera);
  }

  /** Camera, light and floor move as far as the robot did. */
  follow() {
    const [x, y] = this.robot.data.qpos;
    const moved = new THREE.Vector3(x - this.target.x, y - this.target.y, 0);
    this.target.add(moved);
    this.orbit.target.copy(this.target);
    this.camera.position.add(moved);
    this.sun.target.position.copy(this.target);
    this.sun.position.copy(this.target).add(SUN);
    this.floor.position.set(Math.round(x), Math.round(y), 0); // whole tiles, so that the floor seems to stand still
  }

  placeArrow(now) {
    this.arrow.visible = this.pushed !== undefined && now < this.pushed.until;
    if (!this.arrow.visible) return;
    const { direction } = this.pushed;
    this.arrow.setDirection(direction);
    this.arrow.position.copy(this.target).addScaledVector(direction, -0.68);
    this.arrow.position.z = this.robot.data.qpos[2];
  }
}
