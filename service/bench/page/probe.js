// Measures in the page, so that no round trip of the driver is part of a time. Runs before the page's own scripts. Times are ms
// since the page's navigation began, as those of `performance.now()` and of events are.
window.pullfocusProbe = (() => {
  /** Pictures on screen: when they were painted, and the newest request that has its picture there. */
  const drawn = [];
  /** Ids of the requests for live pictures. */
  const asked = [];
  /** Ids of requests by the number of the picture that answers them, until it is acknowledged: then it is on screen. */
  const requestOf = new Map();
  let shown = 0;

  const afterFrame = new MessageChannel();
  const waiting = [];
  afterFrame.port1.onmessage = () => {
    const now = performance.now();
    for (const tell of waiting.splice(0)) tell(now);
  };
  /** Calls back once the frame whose animation callbacks run now is drawn. */
  const onceDrawn = (tell) => {
    if (waiting.push(tell) === 1) afterFrame.port2.postMessage(null);
  };

  const send = WebSocket.prototype.send;
  WebSocket.prototype.send = function (data) {
    const message = typeof data === "string" ? JSON.parse(data) : {};
    if ("ack" in message) {
      shown = Math.max(shown, requestOf.get(message.ack) ?? 0);
      requestOf.delete(message.ack);
    } else if ("id" in message) asked.push(message.id);
    send.call(this, data);
  };
  window.WebSocket = new Proxy(WebSocket, {
    construct(Socket, given) {
      const socket = new Socket(...given);
      socket.addEventListener("message", ({ data }) => {
        if (!(data instanceof ArrayBuffer)) return;
        const end = 4 + new DataView(data).getUint32(0);
        const head = JSON.parse(new TextDecoder().decode(data.slice(4, end)));
        requestOf.set(head.picture, head.id);
      });
      return socket;
    },
  });

  let isNoted = false;
  new MutationObserver((records) => {
    if (isNoted || !records.some(({ target }) => target.matches(".picture > canvas:first-child"))) return;
    isNoted = true; // more pictures before the next frame are not seen
    requestAnimationFrame(() => {
      isNoted = false;
      const id = shown;
      onceDrawn((at) => drawn.push({ at, id }));
    });
  }).observe(document, { subtree: true, attributes: true, attributeFilter: ["width"] });

  const PROPERTIES = ["value", "checked", "textContent"];
  /** The state of elements: a property or an attribute of each. */
  const stateOf = (selector, read) =>
    [...document.querySelectorAll(selector)]
      .map((element) => (PROPERTIES.includes(read) ? element[read] : element.getAttribute(read)))
      .join("\n");

  /** Calls back after each frame until that returns a result, or there is none in time. */
  const untilFrame = (look, since, within, resolve) => {
    const tick = () => {
      const found = look();
      if (found) onceDrawn((at) => resolve(at - since));
      else if (performance.now() - since > within) resolve(null);
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  };

  let result = Promise.resolve(null);
  const atNext = (event, begin) => {
    result = new Promise((resolve) => {
      addEventListener(event, (input) => begin(input.timeStamp, resolve), { capture: true, once: true });
    });
  };

  let noted = null;
  /** A time by the clock that all pages of the machine share. */
  const byClock = (now) => performance.timeOrigin + now;

  return {
    drawn,
    /** Notes when the next event of a kind happens. */
    noteNext(event) {
      addEventListener(event, (input) => (noted = byClock(input.timeStamp)), { capture: true, once: true });
    },
    /** When that was, ms by the clock. */
    noted: () => noted,
    /** Finds when elements show another state, and when the first picture that is asked for from now on is there, ms by the clock. */
    watchOther(selector, read, within) {
      const [since, first, before] = [performance.now(), asked.length, stateOf(selector, read)];
      const seen = (look) => new Promise((resolve) => untilFrame(look, 0, since + within, resolve));
      const value = seen(() => stateOf(selector, read) !== before);
      const picture = seen(() => asked.length > first && shown >= asked[first]);
      result = Promise.all([value, picture]).then((at) =>
        at.includes(null) ? null : { value: byClock(at[0]), picture: byClock(at[1]) },
      );
    },
    /** Measures from the next event of a kind to the frame in which elements show another state. */
    watchState(event, selector, read, within) {
      atNext(event, (since, resolve) => {
        const before = stateOf(selector, read);
        untilFrame(() => stateOf(selector, read) !== before, since, within, resolve);
      });
    },
    /** Measures from the next event of a kind to the frame with the picture that was asked for in answer to it. */
    watchPicture(event, within) {
      atNext(event, (since, resolve) => {
        const first = asked.length;
        untilFrame(() => asked.length > first && shown >= asked[first], since, within, resolve);
      });
    },
    /** What was measured last, ms; null where nothing happened in time. */
    result: () => result,
    /** When the page was up, and its first picture was painted. */
    /** Whether the page has loaded, has painted something, and has drawn a picture. */
    isOpened() {
      const { loaded, painted, picture } = this.opening();
      return loaded > 0 && painted !== null && picture !== null;
    },
    opening() {
      const [navigation] = performance.getEntriesByType("navigation");
      const paint = performance.getEntriesByName("first-contentful-paint")[0];
      return { loaded: navigation.loadEventEnd, painted: paint?.startTime ?? null, picture: drawn[0]?.at ?? null };
    },
  };
})();
