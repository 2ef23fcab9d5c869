// Engine and wind, from speed.

export class Sound {
  private context: AudioContext | null = null;
  private engine: OscillatorNode | null = null;
  private engineGain: GainNode | null = null;
  private windGain: GainNode | null = null;
  on = true;

  /// Begins; only after a key or a button was pressed may a page sound.
  start(): void {
    if (this.context || typeof AudioContext === "undefined") return;
    const context = new AudioContext();
    const low = new BiquadFilterNode(context, { type: "lowpass", frequency: 260 });
    this.engine = new OscillatorNode(context, { type: "sawtooth", frequency: 45 });
    this.engineGain = new GainNode(context, { gain: 0 });
    this.engine.connect(low).connect(this.engineGain).connect(context.destination);
    this.engine.start();
    const noise = context.createBuffer(1, 2 * context.sampleRate, context.sampleRate);
    const data = noise.getChannelData(0);
    for (let i = 0; i < data.length; i++) data[i] = 2 * Math.random() - 1;
    const wind = new AudioBufferSourceNode(context, { buffer: noise, loop: true });
    const band = new BiquadFilterNode(context, { type: "lowpass", frequency: 700 });
    this.windGain = new GainNode(context, { gain: 0 });
    wind.connect(band).connect(this.windGain).connect(context.destination);
    wind.start();
    this.context = context;
  }

  set(speed: number, throttle: number): void {
    const now = this.context?.currentTime ?? 0;
    this.engine?.frequency.setTargetAtTime(38 + 2.1 * speed + 14 * throttle, now, 0.15);
    this.engineGain?.gain.setTargetAtTime(this.on ? 0.02 + 0.05 * throttle : 0, now, 0.1);
    this.windGain?.gain.setTargetAtTime(this.on ? Math.min(0.25, 1.4e-4 * speed * speed) : 0, now, 0.2);
  }

  /// A dull bang, as of metal on metal.
  bang(): void {
    if (!this.context || !this.on) return;
    const { context } = this, now = context.currentTime;
    const noise = context.createBuffer(1, context.sampleRate, context.sampleRate);
    const data = noise.getChannelData(0);
    for (let i = 0; i < data.length; i++) data[i] = 2 * Math.random() - 1;
    const low = new BiquadFilterNode(context, { type: "lowpass", frequency: 420 });
    const gain = new GainNode(context, { gain: 0.8 });
    gain.gain.setTargetAtTime(0, now + 0.06, 0.22);
    const bang = new AudioBufferSourceNode(context, { buffer: noise });
    bang.connect(low).connect(gain).connect(context.destination);
    bang.start();
    this.engineGain?.gain.setTargetAtTime(0, now, 0.05);
    this.windGain?.gain.setTargetAtTime(0, now, 0.05);
  }

  stop(): void {
    void this.context?.close();
    this.context = null;
  }
}
