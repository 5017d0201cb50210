import { Identity } from "@/editor/identity";
import { formatEnd, isSamePerson, keyIdOf, refusalOf, rightsOf, usageOf, type Who } from "@/model/identity";
import { errorOf } from "@/net/errors";
import type { Service } from "@/net/service";
import { turn } from "./fake_service";

const MARA: Who = { id: "key:1", label: "Mara", scopes: ["edit", "read", "render"], project: "tram", endsAt: null };
const PIP: Who = { ...MARA, id: "key:2", label: "Pip", scopes: ["read"] };
const ANYONE: Who = { id: "anyone", label: "anyone", scopes: ["read"], project: "*", endsAt: null };
const KEYS: Readonly<Record<string, Who>> = { maras: MARA, pips: PIP, "maras-new": { ...MARA, id: "key:3" } };

/** A service that knows three keys. */
function locked(): { identity: Identity; loads: () => number; comes: (who: Who) => void; signedOut: () => number } {
  let [loads, signedOut, present] = [0, 0, MARA];
  const service: Partial<Service> = {
    whoAmI: () => Promise.resolve(present),
    signIn: (key) => {
      const who = KEYS[key];
      if (who) return Promise.resolve(who);
      return Promise.reject(errorOf(401, { code: "unauthorized", detail: "The key is wrong, expired or revoked." }));
    },
    signOut: () => Promise.resolve(void (signedOut += 1)),
  };
  const identity = new Identity(service as Service, () => (loads += 1));
  return { identity, loads: () => loads, comes: (who) => (present = who), signedOut: () => signedOut };
}

describe("the use of quotas", () => {
  it("is told for what is limited alone", () => {
    const usage = { shots: { used: 3, allowed: 200 }, storedMb: null, cpuS: { used: 1234.5, allowed: null } };
    expect(usageOf({ ...MARA, usage })).toEqual([{ name: "Shots", value: "3 of 200" }]);
    const cpuS = { used: 1234.5, allowed: 36000 };
    expect(usageOf({ ...MARA, usage: { shots: null, storedMb: null, cpuS } })).toEqual([
      { name: "Work today", value: "1,235 of 36,000 s" },
    ]);
    expect(usageOf(MARA)).toEqual([]);
  });
});

describe("signing in", () => {
  it("is asked once for all requests that wait, and lets them go on", async () => {
    const { identity, loads } = locked();
    const asked = [identity.ask(), identity.ask()];
    expect(identity.asking.value).toBe(true);
    await identity.signIn("maras");
    expect(await Promise.all(asked)).toEqual([true, true]);
    expect([identity.who.value, identity.asking.value, loads()]).toEqual([MARA, false, 0]);
  });

  it("with a wrong key says so and asks on", async () => {
    const { identity } = locked();
    let answer: boolean | null = null;
    void identity.ask().then((signedIn) => (answer = signedIn));
    await identity.signIn("wrong");
    await turn();
    expect([identity.refusal.value, identity.asking.value]).toEqual(["The key is wrong, expired or revoked.", true]);
    expect([answer, identity.trying.value]).toEqual([null, false]);
    await identity.signIn("maras");
    await turn();
    expect([answer, identity.refusal.value]).toEqual([true, null]);
  });

  it("with a new key of the same person goes on, as somebody else loads the page anew", async () => {
    const { identity, loads } = locked();
    await identity.refresh();
    const asked = identity.ask();
    await identity.signIn("maras-new");
    expect([await asked, loads()]).toEqual([true, 0]);

    let settled = false;
    void identity.ask().then(() => (settled = true));
    await identity.signIn("pips");
    await turn();
    // What Mara has still to save is not saved by Pip.
    expect([settled, loads(), identity.who.value?.label]).toEqual([false, 1, "Mara"]);
  });

  it("on a service that was open before is no other person", async () => {
    const { identity, loads, comes } = locked();
    comes(ANYONE);
    await identity.refresh();
    void identity.ask();
    await identity.signIn("pips");
    expect([identity.who.value, loads()]).toEqual([PIP, 0]);
  });
});

describe("the question for a key", () => {
  it("that is left fails what waits and is not asked again by itself", async () => {
    const { identity, loads } = locked();
    const asked = identity.ask();
    identity.dismiss();
    expect([await asked, await identity.ask(), identity.asking.value]).toEqual([false, false, false]);
    identity.askAgain();
    expect(identity.asking.value).toBe(true);
    await identity.signIn("maras");
    expect(loads()).toBe(1);
  });

  it("somebody else in another tab, and signing out, load the page anew", async () => {
    const { identity, loads, comes, signedOut } = locked();
    await identity.refresh();
    comes(PIP);
    await identity.refresh();
    expect(loads()).toBe(1);
    await identity.signOut();
    expect([loads(), signedOut()]).toEqual([2, 1]);
  });
});

describe("what somebody may do", () => {
  it("is said in words", () => {
    expect(rightsOf(MARA)).toBe("look at shots, draw pictures and edit");
    expect([rightsOf(PIP), rightsOf({ ...PIP, scopes: [] })]).toEqual(["look at shots", "do nothing"]);
  });

  it("decides whether shots can be edited and pictures drawn", async () => {
    const { identity, comes } = locked();
    await identity.refresh();
    expect([identity.noEdits.value, identity.noPictures.value]).toEqual([null, null]);
    comes({ ...MARA, scopes: ["read"] });
    await identity.refresh();
    expect(identity.noEdits.value).toBe("Mara may look at shots, not edit.");
    expect(identity.noPictures.value).toBe("Mara may look at shots, not draw pictures.");
    expect(refusalOf(null, "edit")).toBeNull();
  });

  it("a person is told by label and project", () => {
    expect(isSamePerson(MARA, { ...MARA, id: "key:9" })).toBe(true);
    expect(isSamePerson(MARA, { ...MARA, project: "other" })).toBe(false);
  });
});

it("a password manager gets the public part of a key, and nothing of other text", () => {
  expect(keyIdOf(` pf_3f2a9c51d07b_${"x".repeat(43)}`)).toBe("3f2a9c51d07b");
  expect([keyIdOf("hunter2"), keyIdOf("")]).toEqual(["", ""]);
});

it("an end is told by the time today, else by the date too", () => {
  const now = new Date("2026-11-24T08:00:00");
  expect(formatEnd("2026-11-24T20:05:00", now, "en-GB")).toBe("20:05");
  expect(formatEnd("2026-12-01T09:00:00", now, "en-GB")).toBe("1 Dec, 09:00");
  expect(formatEnd("2027-01-02T09:00:00", now, "en-GB")).toBe("2 Jan 2027, 09:00");
});
