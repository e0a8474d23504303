// Texts at places of the map: the chosen surfaces' numbers and the measured distance.
import { h } from './dom.js';

export class Labels {
  constructor(view, stage) {
    this.view = view;
    this.box = h('div', { class: 'labels', 'aria-hidden': 'true' });
    this.labels = [];
    stage.append(this.box);
  }

  // labels: [{ point, text, colour, isAbove }]
  set(labels) {
    this.labels = labels.map(({ point, text, colour, isAbove }) => {
      const element = h('span', {}, text);
      element.style.borderColor = colour;
      return { point, element, isAbove };
    });
    this.box.replaceChildren(...this.labels.map(({ element }) => element));
    this.place();
  }

  place() {
    for (const { point, element, isAbove } of this.labels) {
      const { x, y, isInFront } = this.view.eye.project(point);
      element.style.display = isInFront ? '' : 'none';
      element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, ${isAbove ? '-160%' : '-50%'})`;
    }
  }
}
