import * as THREE from 'three';
import { LEG_COLOURS } from './colours.js';

const VISUAL_GROUP = 2; // of the geoms in the robot's model that are to be seen

/** The robot's visible geoms as three.js meshes, each foot in the colour of its leg. */
export class RobotMesh {
  /** robot: Robot. */
  constructor(robot) {
    this.robot = robot;
    this.group = new THREE.Group();
    this.meshes = [];
    const { geom_group: group, ngeom } = robot.model;
    for (let geom = 0; geom < ngeom; geom++) {
      const shape = group[geom] === VISUAL_GROUP ? shapeOf(robot, geom) : null;
      if (!shape) continue;
      const mesh = new THREE.Mesh(shape, materialOf(robot, geom));
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.matrixAutoUpdate = false;
      this.group.add(mesh);
      this.meshes.push([geom, mesh]);
    }
  }

  /** Take over the poses of the simulation. */
  update() {
    const { geom_xpos: p, geom_xmat: r } = this.robot.data;
    for (const [geom, mesh] of this.meshes) {
      const [a, b] = [3 * geom, 9 * geom];
      mesh.matrix.set(
        ...[r[b], r[b + 1], r[b + 2], p[a]],
        ...[r[b + 3], r[b + 4], r[b + 5], p[a + 1]],
        ...[r[b + 6], r[b + 7], r[b + 8], p[a + 2]],
        ...[0, 0, 0, 1],
      );
    }
  }
}

/** null for a kind of geom that the robots do not have. MuJoCo's cylinders lie along z, those of three.js along y. */
function shapeOf({ mujoco, model }, geom) {
  const [x, y, z] = model.geom_size.subarray(3 * geom, 3 * geom + 3);
  const kind = mujoco.mjtGeom;
  switch (model.geom_type[geom]) {
    case kind.mjGEOM_SPHERE.value:
      return new THREE.SphereGeometry(x, 32, 20);
    case kind.mjGEOM_CAPSULE.value:
      return new THREE.CapsuleGeometry(x, 2 * y, 12, 28).rotateX(Math.PI / 2);
    case kind.mjGEOM_CYLINDER.value:
      return new THREE.CylinderGeometry(x, x, 2 * y, 36).rotateX(Math.PI / 2);
    case kind.mjGEOM_BOX.value:
      return new THREE.BoxGeometry(2 * x, 2 * y, 2 * z);
    default:
      return null;
  }
}

function materialOf(robot, geom) {
  const foot = robot.feet.indexOf(geom);
  const material = robot.model.geom_matid[geom];
  const [r, g, b] =
    material < 0
      ? robot.model.geom_rgba.subarray(4 * geom, 4 * geom + 3)
      : robot.model.mat_rgba.subarray(4 * material, 4 * material + 3);
  const colour = new THREE.Color();
  if (foot < 0) colour.setRGB(r, g, b, THREE.SRGBColorSpace);
  else colour.set(LEG_COLOURS[foot]);
  return new THREE.MeshPhongMaterial({ color: colour, specular: '#333a42', shininess: 40 });
}
