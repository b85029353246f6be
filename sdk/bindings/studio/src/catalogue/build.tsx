// The page of the build: what it left out and why, and what was found in the recordings.

import { Name } from "../parts/name.tsx";
import type { BuildReport } from "./options.ts";

export function Build({ report: { program, planned, missing, leftOut, findings } }: { report: BuildReport }) {
  return (
    <article class="stack">
      <header>
        <h1>Build</h1>
        <p class="soft">
          By {program}. {missing === 0 ? `All ${planned} textures of the recipe are in the library.` : `${planned - missing} of ${planned} textures of the recipe are in the library.`}
        </p>
      </header>
      {leftOut.length > 0 && (
        <section aria-labelledby="left-out-title">
          <h2 id="left-out-title">Left out</h2>
          <dl class="facts">
            {leftOut.map(({ name, reasons }) => (
              <div key={name}>
                <dt>
                  <Name>{name}</Name>
                </dt>
                <dd>
                  <Name>{reasons.join("; ")}</Name>
                </dd>
              </div>
            ))}
          </dl>
          {missing > leftOut.length && <p class="soft small">and {missing - leftOut.length} more, which build-report.json lists</p>}
        </section>
      )}
      <section>
        <h2 id="findings-title">Findings of recordings</h2>
        {findings.length === 0 && <p>None.</p>}
        {findings.length > 0 && (
          <div class="scrolls" tabIndex={0} role="region" aria-labelledby="findings-title">
            <table class="table">
              <thead>
                <tr>
                  <th scope="col">Finding</th>
                  <th scope="col">Severity</th>
                  <th scope="col">Textures</th>
                  <th scope="col">In the library</th>
                  <th scope="col">First ones</th>
                </tr>
              </thead>
              <tbody>
                {findings.map(({ code, severity, textures, inLibrary, first }) => (
                  <tr key={code}>
                    <td>{code}</td>
                    <td>{severity}</td>
                    <td>{textures}</td>
                    <td>{inLibrary}</td>
                    <td>
                      <Name>{first.join(", ")}</Name>
                    </td>
                  </tr>
                ))}
              </tbody>
            </table>
          </div>
        )}
      </section>
    </article>
  );
}
