// Notes the edits that are acknowledged to this page, and the revisions of the edits that it shows.
window.pullfocusUse = { acknowledged: [], shown: [] };
{
  const { acknowledged, shown } = window.pullfocusUse;
  const now = () => performance.timeOrigin + performance.now();
  const send = window.fetch;
  window.fetch = async (...given) => {
    const [request] = given;
    const [address, method] = request instanceof Request ? [request.url, request.method] : [String(request), given[1]?.method];
    const answer = await send(...given);
    const kind = /\/edits(?:\/(undo|redo))?$/.exec(new URL(address, location.href).pathname);
    if (method === "POST" && kind !== null && answer.ok) {
      const atMs = now();
      const body = await answer.clone().json();
      acknowledged.push({ atMs, kind: kind[1] ?? "edit", revision: (body.history ?? body).revision });
    }
    return answer;
  };
  let last = null;
  new MutationObserver(() => {
    const revision = document.querySelector("canvas[data-edits]")?.dataset.edits ?? null;
    if (revision !== null && revision !== last) shown.push({ atMs: now(), revision });
    if (revision !== null) last = revision;
  }).observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ["data-edits"] });
}
