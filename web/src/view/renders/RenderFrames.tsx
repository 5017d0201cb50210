/** The frames of a render: a cell for each, or for some where they are many; the picture and the attempts of one. */

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import {
  failuresOf,
  framesInWords,
  groupsOf,
  lastDrawn,
  TASK_NAMES,
  type FrameGroup,
  type Render,
  type RenderTask,
} from "../../model/renders";
import { shownFormat } from "../../model/frame_files";
import { sentence } from "../../net/errors";
import { formatBytes } from "../numbers";
import { Attempts, type ReadLog } from "./Attempts";
import { FrameCells } from "./FrameCells";

/** Most cells in a grid. */
const MOST_CELLS = 120;

interface RenderFramesProps {
  readonly render: Render;
  /** Null until they are known. */
  readonly tasks: readonly RenderTask[] | null;
  readonly address: (frame: number, format: string) => string;
  /** Address of a small picture of a frame. */
  readonly thumbnail: (frame: number) => string;
  readonly readLog: ReadLog;
}

export function RenderFrames({ render, tasks, address, thumbnail, readLog }: RenderFramesProps): JSX.Element {
  const [chosen, setChosen] = useState<number | null>(null);
  if (tasks === null) return <p class="muted">Reading the frames…</p>;
  const groups = groupsOf(tasks, MOST_CELLS);
  const group = groups.find((each) => each.tasks.some(({ frame }) => frame === chosen)) ?? null;
  const task = group?.tasks.find(({ frame }) => frame === chosen) ?? null;
  const pictured = task?.state === "done" ? task : lastDrawn(tasks);
  const format = shownFormat(render.formats);
  const shown = pictured && (format ? address(pictured.frame, format) : thumbnail(pictured.frame));
  const choose = ({ tasks: [first] }: FrameGroup): void => {
    setChosen(first?.frame ?? null);
  };
  return (
    <>
      {pictured && shown && (
        <Picture key={pictured.files[0]?.sha256} address={shown} label={`Frame ${pictured.frame} of ${render.name}`} />
      )}
      <div class="render-cells">
        <FrameCells label={`Frames of ${render.name}`} groups={groups} chosen={group} onChoose={choose} />
        {group && group.tasks.length > 1 && (
          <>
            <p class="muted">{group.label}</p>
            <FrameCells
              label={group.label}
              groups={groupsOf(group.tasks, group.tasks.length)}
              chosen={task && (groupsOf([task], 1)[0] ?? null)}
              onChoose={choose}
            />
          </>
        )}
        <Failures tasks={tasks} />
        {task ? (
          <Frame task={task} address={address} readLog={readLog} />
        ) : (
          <p class="muted">Choose a frame to see its attempts.</p>
        )}
      </div>
    </>
  );
}

function Picture({ address, label }: { address: string; label: string }): JSX.Element | null {
  const [isLost, setLost] = useState(false);
  if (isLost) return null;
  return (
    <figure class="render-picture">
      <img
        src={address}
        alt={label}
        loading="lazy"
        onError={() => {
          setLost(true);
        }}
      />
      <figcaption class="muted">{label}</figcaption>
    </figure>
  );
}

function Failures({ tasks }: { tasks: readonly RenderTask[] }): JSX.Element | null {
  const failures = failuresOf(tasks);
  if (failures.length === 0) return null;
  return (
    <ul class="render-failures" aria-label="What went wrong">
      {failures.slice(0, MOST_FAILURES).map(({ error, frames }) => (
        <li key={error}>
          <b>{`Frame${frames.length === 1 ? "" : "s"} ${framesInWords(frames)}:`}</b> {sentence(error)}
        </li>
      ))}
    </ul>
  );
}

/** Kinds of failures that are listed. */
const MOST_FAILURES = 5;

interface FrameProps extends Pick<RenderFramesProps, "address" | "readLog"> {
  readonly task: RenderTask;
}

function Frame({ task, address, readLog }: FrameProps): JSX.Element {
  const { frame, state, files } = task;
  return (
    <div class="render-frame" role="group" aria-label={`Frame ${frame}`}>
      <p>
        <b>{`Frame ${frame}`}</b> {TASK_NAMES[state]}
        {state === "done" &&
          files.map(({ format, sizeBytes }) => (
            <a key={format} class="button small" href={address(frame, format)} download>
              {`Download frame ${frame} (.${format}, ${formatBytes(sizeBytes)})`}
            </a>
          ))}
      </p>
      <Attempts task={task} readLog={readLog} />
    </div>
  );
}
