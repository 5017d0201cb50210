/** The products of a render: how far each is, and its file once it is made. */

import type { JSX } from "preact";
import { productInWords, productStateInWords, type RenderProduct } from "../../model/deliverables";
import type { Render } from "../../model/renders";
import { formatBytes } from "../numbers";

interface RenderProductsProps {
  readonly render: Render;
  readonly address: (product: string) => string;
}

export function RenderProducts({ render, address }: RenderProductsProps): JSX.Element | null {
  const { name, products = [] } = render;
  if (products.length === 0) return null;
  return (
    <ul class="render-made" aria-label={`What is made of ${name}`}>
      {products.map((product) => (
        <Product key={product.name} product={product} address={address(product.name)} />
      ))}
    </ul>
  );
}

function Product({ product, address }: { product: RenderProduct; address: string }): JSX.Element {
  const { name, state, sizeBytes } = product;
  const told = productInWords(name);
  return (
    <li class={`product is-${state}`}>
      {state === "done" ? (
        <a class="button small" href={address} download>
          {`Download ${told.charAt(0).toLowerCase()}${told.slice(1)}`}
          {typeof sizeBytes === "number" && <span class="muted">{` ${formatBytes(sizeBytes)}`}</span>}
        </a>
      ) : (
        <>
          {state === "running" && <i class="product-bar" role="progressbar" aria-label={`${told}: being made`} />}
          <span>{told}</span>{" "}
          <span class={state === "failed" ? "render-fault" : "muted"}>{productStateInWords(product)}</span>
        </>
      )}
    </li>
  );
}
