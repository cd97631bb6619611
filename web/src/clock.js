const LONGEST_BACKLOG_S = 1; // more is dropped: a slow device shows slow motion, and a hidden tab stands still
const LEAST_BUDGET_MS = 40; // of computing for one picture; half of the time where pictures take longer

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
    const passedMs = now - (this.last ?? now);
    const budgetMs = Math.max(LEAST_BUDGET_MS, passedMs / 2);
    this.last = now;
    if (this.paused) return;
    this.backlogS = Math.min(this.backlogS + (passedMs / 1000) * this.speed, LONGEST_BACKLOG_S);
    const start = performance.now();
    while (this.backlogS >= this.stepS && performance.now() - start < budgetMs) {
      await tick();
      this.backlogS -= this.stepS;
    }
  }
}
