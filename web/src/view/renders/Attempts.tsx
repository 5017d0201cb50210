/** The attempts at a frame, and the log of each. */

import type { JSX } from "preact";
import { useEffect, useId, useRef, useState } from "preact/hooks";
import { FrameLog } from "../../editor/frame_log";
import { formatEnd } from "../../model/identity";
import type { RenderTask } from "../../model/renders";
import { sentence } from "../../net/errors";
import type { FrameLogText } from "../../net/renders";

export type ReadLog = (frame: number, attempt: number, abort: AbortSignal) => Promise<FrameLogText>;

interface AttemptsProps {
  readonly task: RenderTask;
  readonly readLog: ReadLog;
}

export function Attempts({ task: { frame, attempts }, readLog }: AttemptsProps): JSX.Element {
  return (
    <ol aria-label={`Attempts at frame ${frame}`}>
      {attempts.map((attempt) => (
        <Attempt key={`${frame} ${attempt.number}`} frame={frame} attempt={attempt} readLog={readLog} />
      ))}
    </ol>
  );
}

interface AttemptProps {
  readonly frame: number;
  readonly attempt: RenderTask["attempts"][number];
  readonly readLog: ReadLog;
}

function Attempt({ frame, attempt, readLog }: AttemptProps): JSX.Element {
  const [isOpen, setOpen] = useState(false);
  const log = useId();
  return (
    <li>
      {`${OUTCOMES[attempt.outcome ?? "under way"]}, ${formatEnd(attempt.endedAt ?? attempt.startedAt, new Date())}`}
      <span class="muted"> by {attempt.worker}</span>{" "}
      <button
        type="button"
        class="button small"
        aria-expanded={isOpen}
        aria-controls={isOpen ? log : undefined}
        onClick={() => {
          setOpen(!isOpen);
        }}
      >
        {isOpen ? "Hide log" : "Show log"}
      </button>
      {attempt.error !== null && <span class="render-fault">{sentence(attempt.error)}</span>}
      {isOpen && (
        <Log id={log} label={`Log of attempt ${attempt.number} at frame ${frame}`}>
          {(abort) => readLog(frame, attempt.number, abort)}
        </Log>
      )}
    </li>
  );
}

interface LogProps {
  readonly id: string;
  readonly label: string;
  readonly children: (abort: AbortSignal) => Promise<FrameLogText>;
}

/** Its end is in view, and stays so while lines are added. */
function Log({ id, label, children: read }: LogProps): JSX.Element {
  const [log] = useState(() => new FrameLog(read));
  const box = useRef<HTMLPreElement>(null);
  useEffect(() => log.follow(), [log]);
  const text = log.text.value;
  useEffect(() => {
    box.current?.scrollTo({ top: box.current.scrollHeight });
  }, [text]);
  return (
    <div id={id}>
      {log.complaint.value !== null && (
        <p class="render-fault" role="alert">
          {log.complaint.value}
        </p>
      )}
      {/* It scrolls, so that the keyboard has to reach it. */}
      <pre ref={box} class="render-log" role="log" tabIndex={0} aria-label={label}>
        {text ?? "Reading the log…"}
      </pre>
    </div>
  );
}

type Outcome = NonNullable<RenderTask["attempts"][number]["outcome"]> | "under way";

const OUTCOMES: Readonly<Record<Outcome, string>> = {
  done: "Drawn",
  failed: "Failed",
  lost: "Lost, since its worker is gone",
  "given-back": "Given back, nothing was wrong",
  "under way": "Under way",
};
