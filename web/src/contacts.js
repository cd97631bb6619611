/** Foot contacts over time. A row is four booleans, in the order of the rules' feet. */

/** Rows with the losses of contact closed that last at most bounceS; a loss at either end stays. */
export function debounced(rows, periodS, bounceS) {
  const longest = Math.floor(bounceS / periodS + 1e-9);
  const closed = rows.map((row) => [...row]);
  for (let leg = 0; leg < 4; leg++) {
    let last = -1; // row of the latest contact
    rows.forEach((row, i) => {
      if (!row[leg]) return;
      if (last >= 0 && i - last - 1 <= longest) {
        for (let lost = last + 1; lost < i; lost++) closed[lost][leg] = true;
      }
      last = i;
    });
  }
  return closed;
}

/** The latest rows of a walk, each {contact, velocity, skill, pushed, gait}; `count` numbers all rows ever added. */
export class WalkLog {
  /** capacity: how many rows are kept. */
  constructor(capacity) {
    this.capacity = capacity;
    this.clear();
  }

  clear() {
    this.rows = [];
    this.count = 0;
  }

  add(row) {
    this.rows.push(row);
    this.count += 1;
    if (this.rows.length > this.capacity) this.rows.shift();
  }

  latest(length) {
    return this.rows.slice(-length);
  }
}
