// The cheapest settings of a program for given errors: a ladder of steps for each number of iterations, then halving
// between its rungs. An error is the same in every run, so only the settings near the cheapest need be timed again.

/** What takes longer for a simulated second [ms] counts as not reached. */
export const most_ms = 20_000;
/** Of the least time for an error: what took longer in the search cannot turn out the cheapest. */
const hopeless = 1.6;
const not_better = 4; // rungs

/** `measure(setting)`, with { steps, iterations }, gives { error, ms }: [m], Infinity after a blow-up, and for a simulated
 * second. */
export function search({ least_steps, iterations }, measure, targets) {
  const runs = [];
  const least = targets.map(() => Infinity); // [ms], of any number of iterations
  const look = (setting) => {
    const found = { ...setting, ...measure(setting) };
    runs.push(found);
    targets.forEach((target, t) => {
      if (found.error <= target) least[t] = Math.min(least[t], found.ms);
    });
    return found;
  };

  const climb = (count) => {
    const rungs = [];
    let lowest = Infinity;
    let not_lower = 0;
    for (let steps = least_steps; ; steps *= Math.SQRT2) {
      const found = look({ steps: Math.round(steps), iterations: count });
      rungs.push(found);
      const next = targets.findIndex((target) => lowest > target && found.error > target);
      if (next < 0) return { rungs, ended: "the last target is reached" };
      if (found.ms > hopeless * least[next]) return { rungs, ended: "other iterations are cheaper" };
      if (found.ms * Math.SQRT2 > most_ms) return { rungs, ended: "a shorter step takes too long" };
      not_lower = found.error < 0.98 * lowest || found.error > 20 * targets[0] ? 0 : not_lower + 1;
      if (not_lower === not_better) return { rungs, ended: "a shorter step is no better" };
      lowest = Math.min(lowest, found.error);
    }
  };

  /** The fewest steps, to about 9 %, between the first rung of a ladder that reaches `target` and the one before. */
  const first = ({ rungs }, target) => {
    const at = rungs.findIndex(({ error }) => error <= target);
    let best = rungs[at];
    let below = rungs[at - 1]?.steps;
    for (let halving = 0; best && below && halving < 2; ++halving) {
      const between = Math.round(Math.sqrt(below * best.steps));
      if (between === below || between === best.steps) break;
      const found = look({ steps: between, iterations: best.iterations });
      if (found.error <= target) best = found;
      else below = between;
    }
    return best;
  };

  const ladders = iterations.map(climb);
  // A setting that is the first for several targets is one candidate.
  const known = new Map();
  const candidate = ({ steps, iterations: count, error }) => {
    const key = `${steps} ${count}`;
    if (!known.has(key)) known.set(key, { steps, iterations: count, error, samples: [] });
    return known.get(key);
  };
  const candidates = targets.map((target) => {
    const found = ladders.map((ladder) => first(ladder, target)).filter(Boolean);
    const most = hopeless * Math.min(...found.map(({ ms }) => ms));
    return found.filter(({ ms }) => ms <= most).map(candidate);
  });
  const best = runs.reduce((a, b) => (b.error < a.error ? b : a));
  return { ladders, candidates, best };
}
