// The one name of a body, as the run gives it: "#1 crate", without truth "#1".

export function objectName(run, id) {
  return run.objects.find((object) => object.id === id)?.name ?? `#${id}`;
}

// A body of the truth that was never seen has its true name only.
export function bodyName(run, trueName) {
  return run.errors?.bodies.find((body) => body.true_name === trueName)?.name ?? trueName;
}
