/** What the policy is told at each control step. */

/**
 * One control step of the observation, Float32Array (45 + K): raw readings in SI units, in the order that the metadata
 * name.
 * readings: the robot's own, by entry; command: vx, vy in m/s and yaw rate in rad/s; lastAction: (12,); skill: a name.
 */
export function observe(metadata, readings, command, lastAction, skill) {
  const entries = {
    base_angular_velocity: readings.angularVelocity,
    gravity: readings.gravity,
    command,
    joint_position: readings.jointPosition.map((angle, i) => angle - metadata.default_pose[i]),
    joint_velocity: readings.jointVelocity,
    last_action: lastAction,
    skill: oneHot(metadata, skill),
  };
  return Float32Array.from(metadata.observation.flatMap(({ name, size }) => checked(name, size, entries[name])));
}

/** The last `history` control steps, the oldest first; the first one stands for those before it. */
export function remembered(frames, frame, history) {
  return [...(frames.length ? frames : Array(history).fill(frame)), frame].slice(-history);
}

/** The entry `skill`, (K,): zeros for a policy that does not observe it. */
export function oneHot(metadata, skill) {
  if (!metadata.skills.includes(skill)) {
    throw new Error(`skill "${skill}": unknown to this policy; choose one of ${metadata.skills.join(', ')}`);
  }
  return metadata.skills.map((name) => Number(name === skill && metadata.observe_skill));
}

function checked(name, size, values) {
  if (values === undefined || values.length !== size) {
    throw new Error(`observation "${name}" of size ${size}: not among what this page reads from its robot`);
  }
  return [...values];
}
