/** What the light falls on, how it is developed, and for which display it is graded. */

import type { JSX } from "preact";
import { useEffect } from "preact/hooks";
import type { Editor } from "../../editor/editor";
import type { Session } from "../../editor/session";
import { groupedFilms, type FilmSettings, type FilmSummary } from "../../model/photography";
import { FILM_SLIDERS, type Declared } from "../../model/settings.gen";
import { Choice, Options } from "../controls/Choice";
import { quantityOf } from "../controls/quantity";
import { Edits } from "../controls/Edits";
import { Setting } from "../controls/Setting";
import { Section } from "./Section";

const [NO_FILM, SENSOR, DRAWN] = ["", "*digital", "*drawn"];

interface PartProps {
  readonly session: Session;
  readonly film: FilmSettings;
}

export function FilmPanel({ editor, session, film }: PartProps & { readonly editor: Editor }): JSX.Element {
  const { films } = editor.libraries.value;
  const stock = films.find(({ name }) => name === film.stock);
  const inCamera = film.process !== "none" && film.process !== "digital";
  return (
    <Section
      name="film"
      title="Film"
      aside={
        stock &&
        inCamera && (
          <button
            type="button"
            class="button small"
            title={`Curves, greys, colours and grain of ${stock.title}`}
            onClick={() => (editor.sheet.value = { title: stock.title, address: stock.sheet })}
          >
            Sheet
          </button>
        )
      }
    >
      <div class="fields">
        <Edits session={session}>
          <StockChoice session={session} film={film} films={films} />
          <p class="reason">{descriptionOf(film, stock)}</p>
          {inCamera && film.process !== "reversal" && <PrintChoice session={session} film={film} films={films} />}
          <Balance session={session} film={film} stock={stock} />
          {inCamera &&
            Object.values(OF_FILM).map((declared) => (
              <FilmNumber key={declared.name} session={session} film={film} declared={declared} />
            ))}
        </Edits>
      </div>
    </Section>
  );
}

function StockChoice({ session, film, films }: PartProps & { readonly films: readonly FilmSummary[] }): JSX.Element {
  const drawn = film.process !== "none" && film.process !== "digital" && film.curveSource !== "stock";
  const other = !drawn && film.stock !== "" && !films.some(({ name }) => name === film.stock);
  const value = film.process === "none" ? NO_FILM : film.process === "digital" ? SENSOR : drawn ? DRAWN : film.stock;
  return (
    <Choice
      label="Stock"
      value={value}
      onChoose={(chosen) => {
        const stock = films.find(({ name }) => name === chosen);
        if (stock) session.photography.setFilm(`Load ${stock.title}`, { stock: stock.name }, film);
        else if (chosen === SENSOR)
          session.photography.setFilm("A digital sensor", { stock: null, process: "digital" }, film);
        else if (chosen === NO_FILM) session.photography.setFilm("No film", { stock: null }, film);
      }}
    >
      <option value={NO_FILM}>None: light as it is</option>
      <option value={SENSOR}>Digital sensor</option>
      {drawn && <option value={DRAWN}>Drawn in the shot</option>}
      {other && <option value={film.stock}>{film.stock}</option>}
      {groupedFilms(films).map(([label, members]) => (
        <optgroup key={label} label={label}>
          {members.map(({ name, title }) => (
            <option key={name} value={name}>
              {title}
            </option>
          ))}
        </optgroup>
      ))}
    </Choice>
  );
}

function PrintChoice({ session, film, films }: PartProps & { readonly films: readonly FilmSummary[] }): JSX.Element {
  const prints = films.filter(({ kind, process }) => kind === "print" && process === film.process);
  const known = prints.some(({ name }) => name === film.printStock);
  return (
    <Choice
      label="Print"
      value={film.printStock}
      onChoose={(printStock) => {
        session.photography.setFilm("Print stock", { printStock }, film);
      }}
    >
      {!known && <option value={film.printStock}>{film.printStock || "The usual one"}</option>}
      {prints.map(({ name, title }) => (
        <option key={name} value={name}>
          {title}
        </option>
      ))}
    </Choice>
  );
}

function descriptionOf({ process }: FilmSettings, stock: FilmSummary | undefined): string {
  if (process === "none") return "Scene light goes to the display as it is.";
  if (process === "digital") return "Linear, with a clip; noise from photons and readout.";
  if (!stock) return "A stock of the shot’s own.";
  const speed = stock.speed === null ? "" : `ISO ${stock.speed.toString()}. `;
  return `${speed}${stock.description}`;
}

const { whiteBalanceK: BALANCE, ...OF_FILM } = FILM_SLIDERS;

interface FilmNumberProps extends PartProps {
  readonly declared: Declared & { readonly name: keyof typeof FILM_SLIDERS };
}

function FilmNumber({ session, film, declared }: FilmNumberProps): JSX.Element {
  const { name, label } = declared;
  return (
    <Setting
      {...quantityOf(declared)}
      session={session}
      setting={name}
      keys={film.keys}
      value={film[name]}
      fresh={session.photography.fresh.value}
      startDrag={() => session.photography.dragFilm(label, name, film)}
    />
  );
}

const LIGHTS: readonly (readonly [name: string, kelvin: number])[] = [
  ["As lit", 0],
  ["Tungsten", 3200],
  ["Daylight", 5600],
];

function Balance({ session, film, stock }: PartProps & { readonly stock: FilmSummary | undefined }): JSX.Element {
  return (
    <>
      <FilmNumber session={session} film={film} declared={BALANCE} />
      <div class="group presets" role="group" aria-label="Light that looks neutral">
        {LIGHTS.map(([name, kelvin]) => (
          <button
            key={name}
            type="button"
            class="button small"
            aria-pressed={film.whiteBalanceK === kelvin}
            title={
              stock?.balanceK === kelvin && kelvin > 0
                ? "What the stock is made for"
                : kelvin === 0
                  ? "Leaves the light as it is"
                  : `${kelvin.toString()} K`
            }
            onClick={() => {
              session.photography.setFilm(`Balance: ${name}`, { whiteBalanceK: kelvin }, film);
            }}
          >
            {name}
          </button>
        ))}
      </div>
    </>
  );
}

export function GradePanel({ session, film }: PartProps): JSX.Element | null {
  useEffect(() => {
    session.photography.readGrades();
  }, [session]);
  const grades = session.photography.grades.value;
  if (!grades) return null;
  const display = grades.displays.find(({ name }) => name === (film.display || grades.defaultDisplay));
  const set = (label: string, change: Parameters<typeof session.photography.setFilm>[1]): void => {
    session.photography.setFilm(label, change, film);
  };
  return (
    <Section name="grade" title="Grade">
      <div class="fields">
        <Edits session={session}>
          <Choice
            label="Display"
            value={display?.name ?? film.display}
            onChoose={(name) => {
              const kept = grades.displays.find((one) => one.name === name)?.views.includes(film.view);
              set("Display", { display: name, ...(kept ? {} : { view: "" }) });
            }}
          >
            <Options values={grades.displays.map(({ name }) => name)} />
          </Choice>
          <Choice
            label="View"
            value={film.view || (display?.defaultView ?? "")}
            onChoose={(view) => {
              set("View", { display: display?.name ?? "", view });
            }}
          >
            <Options values={display?.views ?? []} />
          </Choice>
          <Choice
            label="Look"
            value={film.look}
            onChoose={(look) => {
              set("Look", { look });
            }}
          >
            <option value="">None</option>
            {film.look !== "" && !grades.looks.includes(film.look) && <option value={film.look}>{film.look}</option>}
            <Options values={grades.looks} />
          </Choice>
        </Edits>
      </div>
    </Section>
  );
}
