// A run that takes place elsewhere: the page is beside it, and hears of it by Foxglove's WebSocket protocol.
const SUBSCRIPTION = 1, DATA = 1, CONTENT = 13;

export class Live {
  // Whether the page has been served from beside a run.
  static isHere() {
    return document.querySelector('meta[name="beside"]') !== null;
  }

  // `hear` is called with each message as by a `Runner`, `end` when no more come, with the reason.
  constructor(hear, end) {
    this.keys = new Map();
    const address = new URL(".", location.href);
    address.protocol = "ws:";
    address.hash = "";
    this.socket = new WebSocket(address, ["foxglove.websocket.v1"]);
    this.socket.binaryType = "arraybuffer";
    this.socket.onmessage = ({ data }) => {
      if (typeof data === "string") this.told(JSON.parse(data));
      else if (new DataView(data).getUint8(0) === DATA) hear(data, [new DataView(data).getUint8(CONTENT), CONTENT + 1, data.byteLength - CONTENT - 1]);
    };
    this.socket.onclose = () => end("The program has ended, or its connection is lost.");
  }

  told(message) {
    if (message.op === "status") console.warn(message.message);
    if (message.op !== "advertise") return;
    const page = message.channels.find(({ topic }) => topic === "/page");
    if (page) this.send({ op: "subscribe", subscriptions: [{ id: SUBSCRIPTION, channelId: page.id }] });
  }

  send(message) {
    this.socket.send(JSON.stringify(message));
  }

  press(robot, key) {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    if (!this.keys.has(robot)) {
      this.keys.set(robot, this.keys.size + 1);
      const channel = { id: this.keys.get(robot), topic: `/robot${robot + 1}/keys`, encoding: "json", schemaName: "" };
      this.send({ op: "advertise", channels: [channel] });
    }
    const text = new TextEncoder().encode(JSON.stringify({ key })), bytes = new Uint8Array(5 + text.length);
    bytes[0] = DATA;
    new DataView(bytes.buffer).setUint32(1, this.keys.get(robot), true);
    bytes.set(text, 5);
    this.socket.send(bytes);
  }
}
