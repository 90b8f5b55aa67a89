// Two pictures on a page of two runs: one scale, one clock, one view. What is done in one picture is done in the other.

/** Whether the page is one of two runs within another page. */
const together = window.parent !== window && /^run [12]$/.test(window.name);

/** The clock of both runs: "t" or "over", and its first and last time [s]; null on a page of one run. */
const clock = (together && contents.clock) || null;

/** Where the clock was when the motion that goes on began, in either picture; null at rest. Both know it, whatever is still on its way between them. */
const motion = { began: null };

const acts = {};

function post(act, given) {
  if (together) window.parent.postMessage({ act, given }, "*");
}

/** An act by its name, which the other picture repeats. */
function shared(name, act) {
  acts[name] = act;
  return (...given) => {
    act(...given);
    post(name, given);
  };
}

if (together) {
  window.addEventListener("message", ({ source, data }) => {
    if (source === window.parent && Object.hasOwn(acts, data?.act) && Array.isArray(data.given)) acts[data.act](...data.given);
  });
}
