// Cards: a head with lists to choose from, and a plot that is made anew for what is chosen.

class Card {
  /** `make` gives the plot for the state that the lists have chosen. */
  constructor(title, state, make) {
    Object.assign(this, { state, make });
    this.title = element("h3", {}, title);
    this.choices = element("div", { class: "choices" });
    this.head = element("header", {}, this.title, this.choices);
    this.field = element("div", { class: "field" });
    this.body = element("section", { class: "card" }, this.head, this.field);
  }

  /** A list that chooses a member of the state; `then` hears of that before the plot is made. */
  choose(key, label, entries, then = () => {}) {
    return chooser(label, entries, this.state[key], (value) => {
      this.state[key] = value;
      then();
      this.renew();
    });
  }

  renew() {
    this.plot = this.make();
    this.field.replaceChildren(this.plot.sheet.body);
    this.draw();
  }

  draw(width = this.field.clientWidth) {
    if (width) this.plot.draw(width);
  }
}
