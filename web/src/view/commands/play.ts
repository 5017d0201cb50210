/** Commands of time and of playing. */

import type { Playhead } from "../../editor/playhead";
import { EVERY, REPEATS } from "../../model/playback";
import { nextOf, onShot, type Command, type SessionCommand } from "./command";

function onPlayhead(name: string, keys: readonly string[], act: (playhead: Playhead) => void): SessionCommand {
  return {
    name,
    keys,
    act: ({ playhead }) => {
      act(playhead);
    },
  };
}

/** A command that steps through time for as long as its key is held down. */
function step(name: string, keys: readonly string[], frames: number): SessionCommand {
  return {
    ...onPlayhead(name, keys, (playhead) => {
      playhead.step(frames);
    }),
    repeats: true,
  };
}

const PLAYING: readonly SessionCommand[] = [
  onPlayhead("Play or pause", ["Space"], (playhead) => {
    playhead.toggle();
  }),
  onPlayhead("Play, or play faster", ["L"], (playhead) => {
    playhead.shuttle(1);
  }),
  onPlayhead("Play backwards, or faster", ["J"], (playhead) => {
    playhead.shuttle(-1);
  }),
  onPlayhead("Pause", ["K"], (playhead) => {
    playhead.pause();
  }),
  step("One frame back", ["ArrowLeft"], -1),
  step("One frame forward", ["ArrowRight"], 1),
  step("Ten frames back", ["Shift ArrowLeft"], -10),
  step("Ten frames forward", ["Shift ArrowRight"], 10),
  onPlayhead("First frame", ["Home"], (playhead) => {
    playhead.goTo(playhead.range.start);
  }),
  onPlayhead("Last frame", ["End"], (playhead) => {
    playhead.goTo(playhead.range.end);
  }),
  onPlayhead("Play from this frame on", ["I"], (playhead) => {
    playhead.markFirst(playhead.time.value);
  }),
  onPlayhead("Play up to this frame", ["O"], (playhead) => {
    playhead.markLast(playhead.time.value);
  }),
  onPlayhead("Play from the first frame on", ["Shift I"], (playhead) => {
    playhead.markFirst(null);
  }),
  onPlayhead("Play up to the last frame", ["Shift O"], (playhead) => {
    playhead.markLast(null);
  }),
  onPlayhead("Repeat: from the start, back and forth, or not", ["Shift L"], (playhead) => {
    playhead.setRepeat(nextOf(REPEATS, playhead.repeat.value));
  }),
  onPlayhead("Play all frames, every 2nd, 3rd, 4th, 6th or 8th", ["Shift K"], (playhead) => {
    playhead.setEvery(nextOf(EVERY, playhead.every.value));
  }),
];

const CACHING: readonly SessionCommand[] = [
  {
    name: "Cache the frames that are played",
    keys: ["R"],
    isOn: ({ filler }) => filler.asked.value,
    refusal: ({ pictures, filler }) =>
      pictures.refusal ??
      (filler.progress.value.missing === 0 && !filler.asked.value ? "All of them are cached." : null),
    act: ({ filler }) => {
      filler.ask(!filler.asked.value);
    },
  },
  {
    name: "Forget the cached frames",
    keys: ["Shift R"],
    refusal: ({ cache }) => (cache.bytes.value === 0 ? "None are cached." : null),
    act: ({ filler }) => {
      filler.clear();
    },
  },
];

const SHOWN_TIME: readonly SessionCommand[] = [
  {
    name: "Show less of the time",
    keys: ["+", "="],
    repeats: true,
    act: ({ timeView }) => {
      timeView.zoomIn();
    },
  },
  {
    name: "Show more of the time",
    keys: ["-"],
    repeats: true,
    refusal: ({ timeView }) => (timeView.isWhole.value ? "All of it is shown." : null),
    act: ({ timeView }) => {
      timeView.zoomOut();
    },
  },
  {
    name: "Show the selected keys, or the whole shot",
    keys: ["F", "Shift F"],
    wantsKey: ({ keys }, { isInTimeline }) => isInTimeline || keys.selectedStacks.value.length > 0,
    act: ({ timeView, keys }) => {
      timeView.frame(keys.selectedStacks.value.map(({ time }) => time));
    },
  },
];

export const PLAY_COMMANDS: readonly Command[] = [...PLAYING, ...CACHING, ...SHOWN_TIME].map((command) =>
  onShot("Play", command),
);
