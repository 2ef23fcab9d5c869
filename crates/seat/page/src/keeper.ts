// Who keeps what is given: the server that the page came from, or this browser.

import { folder, server, type Keeper } from "./api";
import { Browser } from "./browser";

export const keeper: Keeper = folder ? new Browser(folder) : server;
