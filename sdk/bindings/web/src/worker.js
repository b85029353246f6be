// The worker of a page that renders voices of untrusted models.

import { serve } from "./serve.js";

serve(globalThis);
