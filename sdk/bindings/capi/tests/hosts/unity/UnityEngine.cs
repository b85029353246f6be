// Stubs: the parts of UnityEngine that the package uses, with as much behaviour as its tests need outside Unity. They show that the
// package compiles and calls libhtex as it should, not how Unity runs it.
using System;
using System.Collections.Generic;
using System.Reflection;
using System.Text.RegularExpressions;

namespace AOT
{
    [AttributeUsage(AttributeTargets.Method)]
    public sealed class MonoPInvokeCallbackAttribute : Attribute
    {
        public MonoPInvokeCallbackAttribute(Type type)
        {
        }
    }
}

namespace UnityEngine
{
    public class Object
    {
        public string name { get; set; }

        public static void DestroyImmediate(Object thing)
        {
            ((GameObject)thing).SetActive(false);
        }
    }

    public class ScriptableObject : Object
    {
        public static T CreateInstance<T>() where T : ScriptableObject
        {
            return Activator.CreateInstance<T>();
        }
    }

    public class Component : Object
    {
        internal GameObject Owner;

        public T GetComponent<T>()
        {
            return Owner.GetComponent<T>();
        }
    }

    /// Calls OnEnable and OnDisable as it is enabled, on an active object.
    public class MonoBehaviour : Component
    {
        private bool isEnabled = true;

        public bool enabled
        {
            get { return isEnabled; }
            set
            {
                bool changes = value != isEnabled;
                isEnabled = value;
                if (changes && Owner != null && Owner.activeSelf)
                    Call(value ? "OnEnable" : "OnDisable");
            }
        }

        internal void Call(string name)
        {
            var method = GetType().GetMethod(name, BindingFlags.Instance | BindingFlags.NonPublic);
            if (method != null)
                method.Invoke(this, null);
        }
    }

    /// Calls Awake when it becomes active for the first time, and OnEnable and OnDisable of components that are enabled.
    public sealed class GameObject : Object
    {
        private readonly List<MonoBehaviour> components = new List<MonoBehaviour>();
        private bool isAwake;
        public bool activeSelf { get; private set; }

        public GameObject(string name)
        {
            this.name = name;
            activeSelf = true;
        }

        public T AddComponent<T>() where T : MonoBehaviour, new()
        {
            if (activeSelf)
                throw new NotSupportedException("an active object");
            var component = new T { Owner = this };
            components.Add(component);
            return component;
        }

        public T GetComponent<T>()
        {
            return (T)(object)components.Find(component => component is T);
        }

        public void SetActive(bool value)
        {
            activeSelf = value;
            if (value && !isAwake)
                components.ForEach(component => component.Call("Awake"));
            isAwake |= value;
            foreach (var component in components.FindAll(one => one.enabled))
                component.Call(value ? "OnEnable" : "OnDisable");
        }
    }

    public sealed class AudioSource
    {
    }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class RequireComponent : Attribute
    {
        public RequireComponent(Type type)
        {
        }
    }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class SerializeField : Attribute
    {
    }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class HideInInspector : Attribute
    {
    }

    public static class Application
    {
        public static string streamingAssetsPath;
    }

    public static class AudioSettings
    {
        public static int outputSampleRate = 48000;
    }

    /// Sets the fields that hold texts, of keys that stand once in the JSON.
    public static class JsonUtility
    {
        public static T FromJson<T>(string json)
        {
            var made = (T)Activator.CreateInstance(typeof(T), true);
            foreach (var field in typeof(T).GetFields())
                field.SetValue(made, Regex.Match(json, "\"" + field.Name + "\":\"([^\"]*)\"").Groups[1].Value);
            return made;
        }
    }

    public enum LogType
    {
        Error,
    }

    public static class Debug
    {
        public static int Errors;
        internal static readonly List<Regex> Expected = new List<Regex>();

        public static void LogError(string text)
        {
            int known = Expected.FindIndex(regex => regex.IsMatch(text));
            if (known >= 0)
            {
                Expected.RemoveAt(known);
                return;
            }
            Errors++;
            Console.Error.WriteLine(text);
        }
    }

    public struct Vector2
    {
        public float x, y;

        public static float Distance(Vector2 a, Vector2 b)
        {
            return (float)Math.Sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y));
        }
    }

    public struct Rect
    {
        public Rect(float x, float y, float width, float height)
        {
        }
    }

    public enum EventType
    {
        MouseDown,
        MouseUp,
        Repaint,
    }

    public sealed class Event
    {
        public static Event current = new Event();
        public EventType type;
        public Vector2 mousePosition;
    }

    public static class GUI
    {
        public static void Label(Rect place, string text)
        {
        }
    }

    public static class Screen
    {
        public static float dpi = 254.0f;
    }

    public static class Time
    {
        public static float unscaledDeltaTime = 0.01f;
    }

    public static class Mathf
    {
        public static float Max(float a, float b)
        {
            return Math.Max(a, b);
        }
    }

    public static class Resources
    {
        public static readonly Dictionary<string, Object> Loaded = new Dictionary<string, Object>();

        public static T Load<T>(string path) where T : Object
        {
            return Loaded.ContainsKey(path) ? (T)Loaded[path] : null;
        }
    }
}

namespace UnityEngine.TestTools
{
    public static class LogAssert
    {
        public static void Expect(LogType type, Regex message)
        {
            Debug.Expected.Add(message);
        }

        /// Whether all that was expected came.
        public static bool IsMet { get { return Debug.Expected.Count == 0; } }
    }
}

namespace Unity.Jobs
{
    public interface IJob
    {
        void Execute();
    }
}

namespace Unity.Burst
{
    [AttributeUsage(AttributeTargets.Struct)]
    public sealed class BurstCompileAttribute : Attribute
    {
    }
}
