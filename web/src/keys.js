const SKILL_KEYS = '1234567890-='; // the upper row of a keyboard

/** Which key does what. A slider in focus keeps its own arrow keys. */
export function listenToKeys(controls, actions) {
  const steps = {
    ArrowUp: [0, 1],
    ArrowDown: [0, -1],
    ArrowLeft: [2, 1],
    ArrowRight: [2, -1],
    q: [1, 1],
    e: [1, -1],
  };
  const others = {
    ' ': actions.pause,
    m: actions.slow,
    p: actions.push,
    r: actions.reset,
    x: () => controls.halt(),
  };
  window.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.type === 'range' && event.key.startsWith('Arrow')) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (key.length === 1 && SKILL_KEYS.includes(key)) controls.choose(SKILL_KEYS.indexOf(key));
    else if (key in steps) controls.nudge(...steps[key]);
    else if (key in others && !event.repeat) others[key]();
    else return;
    event.preventDefault();
  });
}
