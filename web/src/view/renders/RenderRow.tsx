/** A render in the list: how far it is, and what can be done with it. */

import type { JSX } from "preact";
import { useEffect, useId, useRef, useState } from "preact/hooks";
import type { Renders } from "../../editor/renders";
import { countProducts } from "../../model/deliverables";
import { formatEnd } from "../../model/identity";
import {
  durationInWords,
  hasDrawn,
  isTaken,
  plural,
  progressInWords,
  RENDER_ACTIONS,
  stateInWords,
  type Render,
  type RenderAction,
} from "../../model/renders";
import { shownFormat } from "../../model/frame_files";
import type { ReportFormat } from "../../net/renders";
import type { ReadLog } from "./Attempts";
import { RenderFrames } from "./RenderFrames";
import { RenderProducts } from "./RenderProducts";

interface RenderRowProps {
  readonly renders: Renders;
  readonly render: Render;
  /** Why the person may change no render; null where they may. */
  readonly refusal: string | null;
  readonly frameAddress: (frame: number, format: string) => string;
  readonly thumbnailAddress: (frame: number) => string;
  readonly productAddress: (product: string) => string;
  readonly reportAddress: (format: ReportFormat) => string;
  readonly readLog: ReadLog;
}

export function RenderRow(props: RenderRowProps): JSX.Element {
  const { renders, render, refusal } = props;
  const [asked, setAsked] = useState<RenderAction | null>(null);
  const frames = useId();
  const head = useRef<HTMLButtonElement>(null);
  const isOpen = renders.opened.value === render.id;
  useEffect(() => {
    if (renders.takeAdded(render.id)) head.current?.focus();
  }); // also of a row that an event brought before the answer
  const act = (action: RenderAction): void => {
    setAsked(null);
    const dialog = head.current?.closest("dialog");
    head.current?.focus(); // the button may go
    void renders.act(render, action).then(() => {
      if (document.activeElement !== document.body) return;
      dialog?.querySelector<HTMLElement>(".render-open, .renders-head .primary")?.focus(); // the row went
    });
  };
  const { name } = render;
  return (
    <li class={`render is-${render.state}`} data-render={render.id}>
      <div class="render-row">
        <button
          ref={head}
          type="button"
          class="render-open"
          aria-expanded={isOpen}
          aria-controls={isOpen ? frames : undefined}
          onClick={() => {
            renders.open(isOpen ? null : render.id);
          }}
        >
          <span class="name">{name}</span>
          <span class="muted">{factsOf(render)}</span>
        </button>
        <Actions
          renders={renders}
          render={render}
          refusal={refusal}
          choose={(action) => {
            if (action === "cancel" || action === "remove") setAsked(action);
            else act(action);
          }}
        />
      </div>
      <Progress render={render} others={renders.all.value ?? []} />
      <RenderProducts render={render} address={props.productAddress} />
      {asked && isTaken(asked, render) && (
        <Question
          action={asked}
          name={name}
          act={act}
          keep={() => {
            setAsked(null);
            head.current?.focus();
          }}
        />
      )}
      {isOpen && <Opened id={frames} {...props} />}
    </li>
  );
}

/** What is shown below the row of a render that is looked at. */
function Opened(props: RenderRowProps & { readonly id: string }): JSX.Element {
  const { id, renders, render, frameAddress, thumbnailAddress, readLog } = props;
  return (
    <div id={id} class="render-frames">
      <Products {...props} />
      {render.count > 0 && (
        <RenderFrames
          render={render}
          tasks={renders.tasks.value}
          address={frameAddress}
          thumbnail={thumbnailAddress}
          readLog={readLog}
        />
      )}
    </div>
  );
}

/** What else can be made of all frames of a render: movie and contact sheet once they are drawn, the report of its focus always. */
function Products({ render, productAddress, reportAddress }: RenderRowProps): JSX.Element {
  const { name, done, formats, products = [] } = render;
  const hasPictures = done > 0 && hasDrawn(render) && shownFormat(formats) !== null;
  const isTold = (product: string): boolean => products.some((each) => each.name === product);
  const reports = (["html", "csv", "json"] as const).filter((format) => !isTold(`focus-report.${format}`));
  return (
    <p class="render-products" role="group" aria-label={`Files of all frames of ${name}`}>
      {hasPictures && !isTold("movie.mp4") && <Download address={productAddress("movie.mp4")}>Download movie</Download>}
      {hasPictures && !isTold("contact-sheet.png") && (
        <Download address={productAddress("contact-sheet.png")}>Download contact sheet</Download>
      )}
      {reports.map((format) => (
        <Download key={format} address={reportAddress(format)}>{`Download focus report (.${format})`}</Download>
      ))}
    </p>
  );
}

function Download({ address, children }: { address: string; children: string }): JSX.Element {
  return (
    <a class="button small" href={address} download>
      {children}
    </a>
  );
}

function factsOf({ frames, width, formats, aovs, rays, owner, createdAt }: Render): string {
  const files = formats.length > 0 ? `${width} px .${formats.join(" .")}, ${plural(rays, "ray")}` : "no frame is drawn";
  const parts = aovs.length > 0 ? ` · AOVs ${aovs.join(", ")}` : "";
  return `Frames ${frames} · ${files}${parts} · by ${owner}, ${formatEnd(createdAt, new Date())}`;
}

function Progress({ render, others }: { render: Render; others: readonly Render[] }): JSX.Element {
  const { count, done, failed, canceled, name, secondsLeft, state, products = [] } = render;
  const all = count + products.length;
  const made = done + countProducts(render, ["done"]);
  const lacking = failed + countProducts(render, ["failed"]);
  const share = (part: number): { width: string } => ({ width: `${(100 * part) / all}%` });
  const progress = progressInWords(render);
  return (
    <div class="render-progress">
      <div
        class="render-bar"
        role="progressbar"
        aria-label={`Progress of ${name}`}
        aria-valuemin={0}
        aria-valuemax={all}
        aria-valuenow={made + lacking + canceled + countProducts(render, ["canceled"])}
        aria-valuetext={progress}
      >
        <i class="done" style={share(made)} />
        <i class="failed" style={share(lacking)} />
      </div>
      <p class="numbers">
        <b>{stateInWords(render, others)}</b>
        {` · ${progress}`}
        {secondsLeft !== null && state === "running" && ` · about ${durationInWords(secondsLeft)} left`}
      </p>
    </div>
  );
}

const ACTION_NAMES: Readonly<Record<RenderAction, string>> = {
  pause: "Pause",
  resume: "Resume",
  accept: "Accept",
  retry: "Retry",
  cancel: "Cancel",
  remove: "Remove",
};

const ACTION_TITLES: Readonly<Record<RenderAction, string>> = {
  pause: "Begin no more frames; those under way are finished",
  resume: "Go on with the frames that wait",
  accept: "Take it as it is, without what has failed or was given up",
  retry: "Make again what has failed or was given up",
  cancel: "Give up what is not drawn or made yet",
  remove: "Remove the render and its files",
};

/** Actions that have a place in each row: where they can do nothing, they stay and are disabled. */
const ALWAYS: readonly RenderAction[] = ["retry"];

interface ActionsProps extends Pick<RenderRowProps, "renders" | "render" | "refusal"> {
  readonly choose: (action: RenderAction) => void;
}

function Actions({ renders, render, refusal, choose }: ActionsProps): JSX.Element {
  const isActing = renders.acting.value.has(render.id);
  const shown = RENDER_ACTIONS.filter((action) => isTaken(action, render) || ALWAYS.includes(action));
  return (
    <div class="render-actions" role="group" aria-label={`Actions on ${render.name}`}>
      {shown.map((action) => (
        <button
          key={action}
          type="button"
          class="button small"
          disabled={refusal !== null || isActing || !isTaken(action, render)}
          title={refusal ?? ACTION_TITLES[action]}
          onClick={({ detail }) => {
            if (detail < 2) choose(action); // the second click of a double click was meant for what was here before
          }}
        >
          {ACTION_NAMES[action]}
        </button>
      ))}
    </div>
  );
}

interface QuestionProps {
  readonly action: RenderAction;
  readonly name: string;
  readonly act: (action: RenderAction) => void;
  readonly keep: () => void;
}

function Question({ action, name, act, keep }: QuestionProps): JSX.Element {
  const yes = useRef<HTMLButtonElement>(null);
  useEffect(() => {
    yes.current?.focus();
  }, []);
  const isRemoval = action === "remove";
  return (
    <div class="ask" role="group" aria-label={`${ACTION_NAMES[action]} ${name}?`}>
      <span>{isRemoval ? "Remove it and its files?" : "Give up what is not drawn or made yet?"}</span>
      <button
        ref={yes}
        type="button"
        class="button"
        onClick={() => {
          act(action);
        }}
      >
        {isRemoval ? "Remove" : "Give up"}
      </button>
      <button type="button" class="button" onClick={keep}>
        {isRemoval ? "Keep" : "Go on"}
      </button>
    </div>
  );
}
