// Time of the replay: which of the shown frames is on the screen. Emits "frame" and "state".

export class Playback extends EventTarget {
  constructor(times) {
    super();
    this.times = times;
    this.frame = 0;
    this.speed = 1;
    this.playing = false;
    this.time = times[0] ?? 0;
  }

  get last() {
    return this.times.length - 1;
  }

  seek(frame) {
    this.time = this.times[Math.min(this.last, Math.max(0, frame))];
    this.#show();
  }

  // The frame nearest to a time of the recording.
  seekTime(time) {
    const after = this.times.findIndex((t) => t >= time);
    if (after <= 0) return this.seek(after < 0 ? this.last : 0);
    this.seek(time - this.times[after - 1] < this.times[after] - time ? after - 1 : after);
  }

  toggle() {
    if (!this.playing && this.frame === this.last) this.seek(0);
    this.playing = !this.playing && this.last > 0;
    this.dispatchEvent(new Event('state'));
    if (this.playing) this.#run();
  }

  #run() {
    let before = performance.now();
    const step = (now) => {
      if (!this.playing) return;
      // A page in the background gets no frames: what was missed is not made up for.
      this.time += Math.min(0.25, Math.max(0, now - before) / 1000) * this.speed;
      before = now;
      this.#show();
      if (this.frame === this.last) {
        this.playing = false;
        this.dispatchEvent(new Event('state'));
        return;
      }
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  #show() {
    let frame = this.times[this.frame] <= this.time ? this.frame : 0;
    while (frame < this.last && this.times[frame + 1] <= this.time) ++frame;
    if (frame === this.frame) return;
    this.frame = frame;
    this.dispatchEvent(new Event('frame'));
  }
}
