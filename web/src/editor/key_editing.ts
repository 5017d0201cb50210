/** The keys of an open shot in lanes: which are selected, and the gestures on them. Each gesture is one edit. */

import { batch, computed, effect, signal } from "@preact/signals";
import type { Changes } from "../model/changes";
import {
  holdAll,
  mapKeys,
  mirrored,
  pasteKeys,
  labelOf,
  firstTime,
  hasValue,
  lengthOf,
  keepMode,
  laneOf,
  removeStacks,
  replaceStacks,
  setKey,
  shaped,
  stackId,
  stretched,
  valued,
  wholeSetting,
  type KeyShape,
  type KeyStack,
  type ValueKey,
  type ValueOwner,
} from "../model/key_lanes";
import type { Key, KeyedSetting } from "../model/keys";
import type { FocusMode } from "../model/shot";
import { formatFrame } from "../model/time";
import { insertion } from "../model/spline";
import { curvesOf } from "../model/value_curves";
import { respanned } from "../model/value_scale";
import type { CameraPlaceReader } from "./camera_place";
import { follow, followKeys, lanesNow, withOwners, withoutGone, type ReadKeys } from "./current_keys";
import type { ShotDocument } from "./document";
import type { Fail } from "./fail";
import { nothingToPasteHint, refusedKeysHint } from "./hints";
import { idsOf, named, shifted, snapping, type KeyDrag, type KeyShift, type Pending } from "./key_drag";
import type { CameraPhotography } from "./photography";
import type { Playhead } from "./playhead";
import type { PointNames } from "./point_names";

const NONE: ReadonlySet<string> = new Set();

/** Parts of a session that keys are edited in. */
interface KeyedParts {
  readonly document: ShotDocument;
  readonly photography: CameraPhotography;
  readonly playhead: Playhead;
  readonly pointNames: PointNames;
  readonly cameraPlace: CameraPlaceReader;
}

const ALL_AS_SAVED: ReadonlyMap<string, KeyStack> = new Map();

export class KeyEditing {
  /** Ids of the selected stacks. */
  readonly selected = signal<ReadonlySet<string>>(NONE);
  /** By their ids, the stacks that are dragged, until the service has them so. */
  readonly #shown = signal<ReadonlyMap<string, KeyStack>>(ALL_AS_SAVED);
  readonly #parts: KeyedParts;
  readonly #read: ReadKeys;
  readonly #fail: Fail;
  #pending: Pending | null = null;

  constructor(parts: KeyedParts, read: ReadKeys, fail: Fail) {
    [this.#parts, this.#read, this.#fail] = [parts, read, fail];
    effect(() => {
      // An undo takes back what edits under way have made.
      if (parts.document.walks.value > 0) this.#forgetPending();
    });
  }

  readonly lanes = computed(() => lanesNow(this.#parts));

  /** What `paste` sets. */
  readonly copied = signal<readonly ValueKey[]>([]);
  #copiedNow: () => readonly ValueKey[] = () => [];
  /** How far a curve may be off that is simplified, as a share. */
  readonly tolerance = signal(0.02);
  /** Id of the curve that is drawn in place of the focus curve; null for none. */
  readonly graphed = signal<string | null>(null);

  /** The curves of the keys. */
  readonly curves = computed(() => curvesOf(this.lanes.value));

  /** The curve that is drawn, as the service has it and as it is shown; null for the focus curve. */
  readonly graph = computed(() => {
    const saved = this.curves.value.find(({ id }) => id === this.graphed.value);
    if (!saved) return null;
    const lanes = this.lanes.value.filter(({ id }) => saved.keys[0]?.stack.lane === id);
    const shown = curvesOf(lanes, (stack) => this.shownAs(stack)).find(({ id }) => id === saved.id);
    return { saved, shown: shown ?? saved };
  });

  readonly selectedStacks = computed<readonly KeyStack[]>(() => {
    const selected = this.selected.value;
    return this.lanes.value.flatMap(({ stacks }) => stacks).filter(({ id }) => selected.has(id));
  });

  /** The setting all of whose keys are selected, where they can be made fewer; null for none. */
  readonly whole = computed(() => wholeSetting(this.selectedStacks.value, this.lanes.value));

  /** Reason why the selected keys cannot be stretched to the playhead; null where they can. */
  get noStretch(): string | null {
    const times = this.selectedStacks.value.map(({ time }) => time);
    if (new Set(times).size < 2) return "All selected keys are at one time.";
    return this.#parts.playhead.time.value > Math.min(...times)
      ? null
      : "The playhead is not after the first selected key.";
  }

  /** Reason why keys may not be edited; null where they may. */
  get noEdits(): string | null {
    return this.#parts.document.noEdits.value;
  }

  /** Whether something is dragged, which nothing else may interfere with. */
  get isDragged(): boolean {
    return this.#parts.document.dragging.peek();
  }

  /** A stack as it is shown. */
  shownAs(stack: KeyStack): KeyStack {
    return this.#shown.value.get(stack.id) ?? stack;
  }

  /** Selects stacks in place of others; with `adds`, beside them, or no longer where all of them are selected. */
  select(stacks: readonly KeyStack[], adds = false): void {
    const ids = idsOf(stacks);
    const underWay = this.#pending?.of ?? [];
    // Edits of these very stacks may be under way: they are shown as they are to be.
    const isSame = underWay.length === ids.length && ids.every((id) => underWay.some((of) => of.has(id)));
    if (!adds && isSame && ids.length > 0) return;
    this.#forgetPending();
    const before = this.selected.value;
    if (!adds) this.selected.value = new Set(ids);
    else if (ids.every((id) => before.has(id)))
      this.selected.value = new Set([...before].filter((id) => !ids.includes(id)));
    else this.selected.value = new Set([...before, ...ids]);
  }

  /** Selects all keys of the lanes that have a selected one. */
  selectLanes(): void {
    const lanes = new Set(this.selectedStacks.value.map(({ lane }) => lane));
    this.select(this.lanes.value.filter(({ id }) => lanes.has(id)).flatMap(({ stacks }) => stacks));
  }

  /** Selects nothing; returns whether anything was selected. */
  clear(): boolean {
    this.#forgetPending();
    const had = this.selectedStacks.value.length > 0;
    this.selected.value = NONE;
    return had;
  }

  /**
   * Starts a drag of the selected stacks.
   *
   * @param grabbed stack under the pointer, which snaps.
   */
  drag(grabbed: KeyStack): KeyDrag {
    const base = this.#base();
    const { stacks } = base;
    const lanes = new Set(stacks.map(({ lane }) => lane));
    const from = this.shownAs(grabbed).time;
    const { document, playhead } = this.#parts;
    // Not to the lane's other keys, which would be replaced.
    const others = this.lanes.peek().flatMap((lane) => (lanes.has(lane.id) ? [] : lane.stacks));
    const targets = [playhead.time.peek(), ...others.map(({ time }) => time)];
    const snapped = snapping(playhead.range, stacks, from, targets);
    const after = (shift: KeyShift): readonly KeyStack[] => shifted(stacks, shift, snapped(shift));
    return {
      move: (shift) => {
        const moved = after(shift);
        const changes = replaceStacks(stacks, moved, this.#mode);
        playhead.pause();
        batch(() => {
          this.#show(base, moved);
          if (!refusedKeysHint(changes)) document.preview(changes);
        });
      },
      commit: async (shift) => {
        const label = snapped(shift) === 0 ? `Shape ${named(stacks)}` : `Move ${named(stacks)}`;
        return (await this.#apply(label, base, after(shift))) ? from + snapped(shift) : null;
      },
      cancel: () => {
        if (this.#pending === base) this.#show(base, stacks);
        else this.#shown.value = ALL_AS_SAVED;
        document.endPreview();
      },
    };
  }

  /** Moves the selected stacks together, so that the first one comes to a time of the shot. */
  moveTo(time: number): void {
    this.#change("Move", (stacks) => {
      const by = holdAll(this.#parts.playhead.range, stacks, time - firstTime(stacks));
      return shifted(stacks, {}, by);
    });
  }

  /** Adds a key to a curve, which stays as it is, and selects it. */
  async add(owner: ValueOwner, keys: readonly Key[], time: number): Promise<void> {
    this.clear();
    const changes = insertion(keys, time).map((key) => setKey(owner, key));
    const isMade = await this.#edit(`Add the key at ${formatFrame(time)}`, keepMode(changes, [owner], this.#mode));
    if (isMade && this.selected.value.size === 0) this.selected.value = new Set([stackId(laneOf(owner), time)]);
  }

  /** Keeps the selected keys for `paste`. */
  copy(): void {
    const copied = this.#base().stacks.flatMap(({ keys }) => keys.filter(hasValue));
    if (copied.length === 0) return;
    this.copied.value = copied;
    this.#copiedNow = followKeys(this.copied.peek(), this.#parts.pointNames);
  }

  /** Sets the copied keys, the first of which comes to the playhead, and selects them. */
  async paste(): Promise<void> {
    const { playhead, document } = this.#parts;
    if (this.copied.peek().length === 0 || this.isDragged) return;
    const copied = withOwners(this.#copiedNow(), document.points.peek());
    if (copied.length === 0) {
      this.#fail(nothingToPasteHint(), () => undefined);
      return;
    }
    const time = playhead.time.peek();
    this.clear();
    const isMade = await this.#edit(`Paste ${copied.length.toString()} keys`, pasteKeys(copied, time, this.#mode));
    if (!isMade || this.selected.value.size > 0) return;
    const by = time - Math.min(...copied.map(({ key }) => key.time));
    this.selected.value = new Set(copied.map(({ owner, key }) => stackId(laneOf(owner), key.time + by)));
  }

  /** Turns the selected keys round in time. */
  mirror(): void {
    this.#change("Mirror", mirrored);
  }

  /** Stretches the selected keys from the first one on, until the last is so many frames after it. */
  stretchTo(frames: number): void {
    if (frames > 0) this.#change("Stretch", (stacks) => stretched(stacks, frames / lengthOf(stacks)));
  }

  /** Stretches the selected keys from the first one on, so that the last comes to the playhead. */
  stretchToPlayhead(): void {
    this.stretchTo(this.#parts.playhead.time.peek() - firstTime(this.#base().stacks));
  }

  /** Spreads the values of the selected keys, which are all of one curve, from a lowest to a highest one. */
  respan(least: number, most: number): void {
    this.#change("Scale", (stacks) => respanned(stacks, least, most));
  }

  /** Replaces all keys of a setting by few, which are selected then. */
  async simplify(setting: KeyedSetting): Promise<void> {
    const tolerance = this.tolerance.peek();
    const before = this.selected.value;
    const label = `Simplify the ${labelOf({ setting }).toLowerCase()}`;
    const isMade = await this.#edit(label, [{ type: "simplifySetting", setting, tolerance }]);
    if (!isMade || this.selected.value !== before) return;
    const stop = effect(() => {
      if (!this.#parts.document.fresh.value) return;
      queueMicrotask(() => {
        stop();
        if (this.selected.peek() !== before) return;
        const lane = this.lanes.peek().find(({ id }) => id === laneOf({ setting }));
        this.select(lane?.stacks ?? []);
      });
    });
  }

  async remove(): Promise<void> {
    if (this.isDragged) return;
    const base = this.#base();
    const { stacks } = base;
    const before = this.selected.value;
    const edited = this.#edit(`Remove ${named(stacks)}`, removeStacks(stacks), base);
    // What is done to them meanwhile is done to none.
    const pending: Pending = { of: this.#idsNow(base), stacks: [], isMade: edited };
    this.#pending = pending;
    const isMade = await edited;
    if (this.#pending === pending) this.#forgetPending();
    if (isMade && this.selected.value === before) this.clear();
  }

  shape(shape: KeyShape): void {
    this.#change("Shape", (stacks) => mapKeys(stacks, (owned) => shaped(owned, shape)));
  }

  /** Sets the value of the only selected key. */
  setValue(value: number): void {
    this.#change("Set the value of", (stacks) => mapKeys(stacks, (owned) => valued(owned, value)));
  }

  /** Changes the selected stacks. */
  #change(what: string, change: (stacks: readonly KeyStack[]) => readonly KeyStack[]): void {
    const base = this.#base();
    void this.#apply(`${what} ${named(base.stacks)}`, base, change(base.stacks));
  }

  get #mode(): FocusMode {
    return this.#parts.document.readout.peek()?.focusMode ?? "manual";
  }

  /** The selected stacks, as the edits under way leave them. */
  #base(): Pending {
    if (this.#pending) return this.#pending;
    const stacks = this.selectedStacks.peek();
    return { of: stacks.map(({ id }) => new Set([id])), stacks };
  }

  /** Shows stacks as they are to be. */
  #show(base: Pending, after: readonly KeyStack[]): void {
    const of = this.#idsNow(base).map((ids) => [...ids]);
    this.#shown.value = new Map(after.flatMap((stack, place) => of[place]?.map((id) => [id, stack] as const) ?? []));
  }

  /** The ids by which the service may have stacks: those before the edits under way, and those after each of them. */
  #idsNow(base: Pending): ReadonlySet<string>[] {
    const before = this.#pending === base ? base.of : [];
    return base.stacks.map(({ id }, place) => new Set([...(before[place] ?? []), id]));
  }

  /** Shows the keys as the service has them, though edits of them may be under way. */
  #forgetPending(): void {
    this.#pending = null;
    this.#shown.value = ALL_AS_SAVED;
  }

  /** Whether the newest edit under way is this one; with null, whether there is any. */
  #isUnderWay(pending: Pending | null): boolean {
    return this.#pending !== null && (pending === null || this.#pending === pending);
  }

  /** Edits stacks, which stay selected as they are afterwards. */
  async #apply(label: string, base: Pending, after: readonly KeyStack[]): Promise<boolean> {
    this.#show(base, after);
    const edited = this.#edit(label, replaceStacks(base.stacks, after, this.#mode), base);
    const pending: Pending = { of: this.#idsNow(base), stacks: after, isMade: edited };
    const before = pending.of.flatMap((ids) => [...ids]);
    this.#pending = pending;
    this.selected.value = new Set([...before, ...idsOf(after)]); // those that the service will have, too
    const isMade = await edited;
    if (this.#isUnderWay(isMade ? pending : null)) {
      batch(() => {
        this.#forgetPending();
        this.selected.value = new Set(isMade ? idsOf(after) : before);
      });
    }
    return isMade;
  }

  /**
   * Makes an edit that the picture shows at once; resolves to whether it was made.
   *
   * @param base what it edits, as the edit before it leaves that: without that one, it is not made either.
   */
  async #edit(label: string, changes: Changes, base?: Pending): Promise<boolean> {
    const { document, playhead, photography, pointNames, cameraPlace } = this.#parts;
    const hint = refusedKeysHint(changes);
    if (hint) {
      document.endPreview();
      this.#fail(hint, () => undefined);
      return false;
    }
    playhead.pause();
    document.unsaved.value = changes;
    // What was read may change by edits under way.
    const isSettled = document.pending.peek() === 0 && !base?.isMade && document.hasFreshPoints;
    const isRead = isSettled && document.fresh.peek() && photography.fresh.peek() && cameraPlace.fresh.peek();
    const renamed = follow(changes, pointNames);
    const now = async (): Promise<Changes> =>
      (await base?.isMade) === false ? [] : withoutGone(renamed(), this.#read);
    const edited = document.edit(label, isRead ? changes : now, changes);
    document.dragging.value = false;
    const isMade = await edited;
    if (!isMade && document.unsaved.value === changes) document.endPreview();
    return isMade;
  }
}
