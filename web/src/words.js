/** Texts of the page that are made from the policy's names. */

/** "trot" -> "Trot", "slow_walk" -> "Slow walk". */
export function spoken(name) {
  const words = name.replaceAll('_', ' ');
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** The range's name ends with its unit: what a slider is called, its unit, and its words for below and above 0. */
export const COMMANDS = {
  vx_m_s: { title: 'Speed', unit: 'm/s', below: 'backward', above: 'forward' },
  vy_m_s: { title: 'Sideways', unit: 'm/s', below: 'right', above: 'left' },
  yaw_rate_rad_s: { title: 'Turn', unit: 'rad/s', below: 'right', above: 'left' },
};

/** A command's value such as "0.60 m/s forward". */
export function commandText(value, { unit, below, above }) {
  const side = Math.abs(value) < 0.005 ? '' : ` ${value < 0 ? below : above}`;
  return `${Math.abs(value).toFixed(2)} ${unit}${side}`;
}
