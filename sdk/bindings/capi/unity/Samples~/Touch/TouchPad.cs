// Makes the window a surface. The mouse, or a finger on a touch screen, moves over it and sets the
// speed and force of a texture.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using UnityEngine;

namespace Htex.Samples
{
    /// <summary>
    /// Passes speed and force to an HtexSource. The scene leaves the HtexSource disabled until its
    /// texture is loaded.
    /// </summary>
    [RequireComponent(typeof(HtexSource))]
    public sealed class TouchPad : MonoBehaviour
    {
        /// <summary>Name of the texture in a Resources folder.</summary>
        public string Texture = "Vinyl";
        /// <summary>
        /// Normal force, N: ForceN without a pressed button, PressedForceN with one.
        /// </summary>
        public float ForceN = 0.4f, PressedForceN = 0.8f;

        private HtexSource source;
        private Vector2 last;
        private bool isPressed;
        private string label = "";

        private void Awake()
        {
            source = GetComponent<HtexSource>();
            source.Texture = Resources.Load<HtexTexture>(Texture);
            if (source.Texture == null)
            {
                Debug.LogError("htex: no texture " + Texture + " in a folder Resources");
                return;
            }
            label = source.Texture.Title + ": move the mouse; press to push harder";
            source.enabled = true;
        }

        /// <summary>
        /// Uses GUI events, because they work with every setting of Active Input Handling.
        /// </summary>
        private void OnGUI()
        {
            var now = Event.current;
            if (now.type == EventType.MouseDown)
                isPressed = true;
            else if (now.type == EventType.MouseUp)
                isPressed = false;
            else if (now.type == EventType.Repaint)
                Follow(now.mousePosition);
            GUI.Label(new Rect(16.0f, 16.0f, 600.0f, 24.0f), label);
        }

        private void Follow(Vector2 place)
        {
            // If the screen does not report its density, 96 dots per inch are assumed.
            float mmPerPixel = 25.4f / (Screen.dpi > 0.0f ? Screen.dpi : 96.0f);
            source.SpeedMmS = Vector2.Distance(place, last) * mmPerPixel / Mathf.Max(Time.unscaledDeltaTime, 0.001f);
            source.ForceN = isPressed ? PressedForceN : ForceN;
            last = place;
        }
    }
}
