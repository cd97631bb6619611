/** Skills: a gait, or a gait at one stride frequency. A skill's name is its gait or such as "trot_2hz". */

/** {gait, frequencyHz} of a skill's name; frequencyHz is null where the skill is a gait at any frequency. */
export function splitName(name) {
  const match = /^(.+)_([0-9.]+)hz$/.exec(name);
  return match ? { gait: match[1], frequencyHz: Number(match[2]) } : { gait: name, frequencyHz: null };
}

/** The name of the skill that a measured gait and stride frequency show; null for others. */
export function performed(gait, frequencyHz, names, rules) {
  let best = { name: null, miss: rules.frequency_tolerance };
  for (const name of names) {
    const skill = splitName(name);
    if (skill.gait !== gait) continue;
    const miss = skill.frequencyHz === null ? 0 : Math.abs(frequencyHz / skill.frequencyHz - 1);
    if (best.name === null ? miss <= best.miss : miss < best.miss) best = { name, miss };
  }
  return best.name;
}
