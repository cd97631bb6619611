const LONGEST_BACKLOG_S = 0.25; // more is dropped: a slow device shows slow motion, and a hidden tab stands still
const BUDGET_MS = 40; // of computing for one picture

/** Turns time that has passed on the screen into physics timesteps. */
export class Clock {
  /** stepS: one physics timestep. */
  constructor(stepS) {
    this.stepS = stepS;
    this.speed = 1; // simulated seconds per second
    this.paused = false;
    this.backlogS = 0;
    this.last = null;
  }

  /** Run `tick` as often as the time since the last call asks for. now: ms. */
  async advance(now, tick) {
    const passed = this.last === null || this.paused ? 0 : ((now - this.last) / 1000) * this.speed;
    this.last = now;
    this.backlogS = Math.min(this.backlogS + passed, LONGEST_BACKLOG_S);
    const start = performance.now();
    while (this.backlogS >= this.stepS && performance.now() - start < BUDGET_MS) {
      await tick();
      this.backlogS -= this.stepS;
    }
  }
}
