// The Node.js thread that renders voices of untrusted models.

import { parentPort } from "node:worker_threads";

import { serve } from "./serve.js";

serve(parentPort);
