// Plays a texture at pin DAC0 or A0. Reads the force of the finger at pin A1 and its speed at A2.
//
// `htex bake cloth.htex --name texture_cloth -o cloth.h` writes cloth.h. The sample rate is 8 kHz.
// A board that takes more than 125 us per sample is too slow, e.g. one without floating point.
// `late` counts the samples that came too late.
#include <htex_player.h>

#include "cloth.h"

#if defined(DAC0)
const uint8_t OUTPUT_PIN = DAC0;
#else
const uint8_t OUTPUT_PIN = A0;
#endif
const uint8_t FORCE_PIN = A1;
const uint8_t SPEED_PIN = A2;

// Force and speed at the full scale of the sensors: replace these values by your board's.
const float MOST_FORCE_N = 1.0f;
const float MOST_SPEED_MM_S = 200.0f;

static HTEX_PLAYER_MEMORY(memory, TEXTURE_CLOTH_NUMBERS);
static htex_player *const player = &memory.player;
static uint32_t period_us;
static uint32_t next_us;
static uint32_t next_reading_us;
static uint32_t late;

void setup() {
  Serial.begin(115200);
  int status = htex_player_open(player, sizeof memory, texture_cloth, sizeof texture_cloth, 1);
  if (status != HTEX_PLAYER_OK) {
    Serial.print("the texture is refused: ");
    Serial.println(status);
    while (true) {
    }
  }
  period_us = (uint32_t)(1e6f / htex_player_rate_hz(player) + 0.5f);
  next_us = micros();
  next_reading_us = next_us;
}

void loop() {
  uint32_t now_us = micros();
  if ((int32_t)(now_us - next_us) < 0) {
    return;
  }
  if ((int32_t)(now_us - next_us) > (int32_t)period_us) {
    late++;
  }
  next_us += period_us;
  // A reading every 10 ms.
  if ((int32_t)(now_us - next_reading_us) >= 0) {
    next_reading_us = now_us + 10000;
    float force_n = MOST_FORCE_N / 1023.0f * (float)analogRead(FORCE_PIN);
    float speed_mm_s = MOST_SPEED_MM_S / 1023.0f * (float)analogRead(SPEED_PIN);
    htex_player_set_motion(player, speed_mm_s, force_n);
  }
  int16_t sample;
  htex_player_render_i16(player, &sample, 1, htex_player_full_scale(player));
  // analogWrite takes 8 bits unless it is set to another resolution.
  analogWrite(OUTPUT_PIN, (uint8_t)(128 + sample / 256));
}
