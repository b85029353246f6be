// The worker of a page that renders the voices of models that are not trusted.

import { serve } from "./serve.js";

serve(globalThis);
