// The thread of Node.js that renders the voices of models that are not trusted.

import { parentPort } from "node:worker_threads";

import { serve } from "./serve.js";

serve(parentPort);
